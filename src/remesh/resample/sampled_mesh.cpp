// Splits, collapses and flips edges.
#include "remesh/resample/sampled_mesh.h"

#include <algorithm>
#include <utility>

namespace sherd {

namespace {

int after(int k) { return k == 2 ? 0 : k + 1; }

}  // namespace

SampledMesh::SampledMesh(std::vector<glm::dvec3> vertices, std::vector<Face> faces)
    : at_(std::move(vertices)), faces_(std::move(faces)), around_(at_.size()) {
  for (Index f = 0; f < faces_.size(); ++f) {
    for (const Index v : faces_[f].corner) around_[v].push_back(f);
  }
}

SampledMesh::Sides SampledMesh::sidesOf(Index a, Index b) const {
  Sides sides;
  for (const Index f : around_[a]) {
    const Face& face = faces_[f];
    const auto k = static_cast<std::size_t>(face.indexOf(a));
    if (face.corner[(k + 1) % 3] == b) {
      sides.left = f;
      sides.leftApex = face.corner[(k + 2) % 3];
    } else if (face.corner[(k + 2) % 3] == b) {
      sides.right = f;
      sides.rightApex = face.corner[(k + 1) % 3];
    }
  }
  return sides;
}

bool SampledMesh::isFeature(Index a, Index b) const {
  const Face& left = faces_[sidesOf(a, b).left];
  return left.isFeature[static_cast<std::size_t>(left.indexOf(a))];
}

std::vector<SampledMesh::Index> SampledMesh::featuresAt(Index v) const {
  std::vector<Index> ends;
  for (const Index f : around_[v]) {
    const auto k = static_cast<std::size_t>(faces_[f].indexOf(v));
    if (faces_[f].isFeature[k]) ends.push_back(faces_[f].corner[(k + 1) % 3]);
  }
  return ends;
}

void SampledMesh::replaceFace(Index v, Index from, Index to) {
  *std::find(around_[v].begin(), around_[v].end(), from) = to;
}

void SampledMesh::removeFace(Index v, Index face) {
  around_[v].erase(std::find(around_[v].begin(), around_[v].end(), face));
}

SampledMesh::Index SampledMesh::splitEdge(Index a, Index b, const glm::dvec3& at) {
  const auto v = static_cast<Index>(at_.size());
  const Sides sides = sidesOf(a, b);
  at_.push_back(at);
  around_.emplace_back();
  // A face (a, b, c) or (b, a, c) keeps `a`; the new one has `b`.
  for (const Index f : {sides.left, sides.right}) {
    const auto added = static_cast<Index>(faces_.size());
    faces_.push_back(faces_[f]);
    const int ofA = faces_[f].indexOf(a), ofB = faces_[f].indexOf(b);
    const auto i = static_cast<std::size_t>(ofA), j = static_cast<std::size_t>(ofB);
    const std::size_t c = 3 - i - j;
    const Index apex = faces_[f].corner[c];
    faces_[f].corner[j] = v;
    faces_[added].corner[i] = v;
    // The edge between `v` and the apex is new.
    faces_[f].isFeature[after(ofB) == static_cast<int>(c) ? j : c] = false;
    faces_[added].isFeature[after(ofA) == static_cast<int>(c) ? i : c] = false;
    replaceFace(b, f, added);
    around_[apex].push_back(added);
    around_[v].push_back(f);
    around_[v].push_back(added);
  }
  return v;
}

SampledMesh::Index SampledMesh::splitFace(Index face, const glm::dvec3& at) {
  const auto v = static_cast<Index>(at_.size());
  at_.push_back(at);
  around_.emplace_back();
  const Face whole = faces_[face];
  for (std::size_t k = 0; k < 3; ++k) {
    const Index f = k == 0 ? face : static_cast<Index>(faces_.size());
    const Index from = whole.corner[k], to = whole.corner[(k + 1) % 3];
    const Face part{{from, to, v}, {whole.isFeature[k], false, false}, whole.source};
    if (k == 0) {
      faces_[face] = part;
      removeFace(whole.corner[2], face);
    } else {
      faces_.push_back(part);
      around_[from].push_back(f);
      around_[to].push_back(f);
    }
    around_[v].push_back(f);
  }
  return v;
}

bool SampledMesh::mayCollapse(Index gone, Index kept) const {
  const Sides sides = sidesOf(gone, kept);
  std::size_t common = 0;
  for (const Index f : around_[gone]) {
    const auto k = static_cast<std::size_t>(faces_[f].indexOf(gone));
    const Index end = faces_[f].corner[(k + 1) % 3];
    if (end == kept) continue;
    for (const Index g : around_[kept]) {
      if (faces_[g].indexOf(end) >= 0) {
        ++common;
        break;
      }
    }
  }
  if (common != 2 || around_[sides.leftApex].size() <= 3 || around_[sides.rightApex].size() <= 3) {
    return false;
  }
  for (const Index f : {sides.left, sides.right}) {  // both other edges are features
    const auto& own = faces_[f].isFeature;
    const auto i = static_cast<std::size_t>(faces_[f].indexOf(gone)),
               j = static_cast<std::size_t>(faces_[f].indexOf(kept));
    const std::size_t edge = (i + 1) % 3 == j ? i : j;
    if (own[(edge + 1) % 3] && own[(edge + 2) % 3]) return false;
  }
  return true;
}

void SampledMesh::collapse(Index gone, Index kept) {
  const Sides sides = sidesOf(gone, kept);
  for (const auto& [face, apex] :
       {std::pair(sides.left, sides.leftApex), std::pair(sides.right, sides.rightApex)}) {
    const bool isEdge = isFeature(gone, apex) || isFeature(kept, apex);
    for (const Index end : {gone, kept}) {  // both edges become one
      const Sides own = sidesOf(end, apex);
      const Index other = own.left == face ? own.right : own.left;
      Face& beside = faces_[other];
      const auto i = static_cast<std::size_t>(beside.indexOf(end)),
                 j = static_cast<std::size_t>(beside.indexOf(apex));
      beside.isFeature[(i + 1) % 3 == j ? i : j] = isEdge;
    }
  }
  for (const Index f : {sides.left, sides.right}) {
    for (const Index v : faces_[f].corner) {
      if (v != gone) removeFace(v, f);
    }
    faces_[f].corner = {kNone, kNone, kNone};
  }
  for (const Index f : around_[gone]) {
    if (faces_[f].isGone()) continue;
    faces_[f].corner[static_cast<std::size_t>(faces_[f].indexOf(gone))] = kept;
    around_[kept].push_back(f);
  }
  around_[gone].clear();
}

bool SampledMesh::mayFlip(Index a, Index b) const {
  const Sides sides = sidesOf(a, b);
  if (around_[a].size() <= 3 || around_[b].size() <= 3) return false;
  const auto isBeside = [&](Index f) { return faces_[f].indexOf(sides.rightApex) >= 0; };
  return sides.leftApex != sides.rightApex &&
         std::none_of(around_[sides.leftApex].begin(), around_[sides.leftApex].end(), isBeside);
}

void SampledMesh::flip(Index a, Index b) {
  const Sides sides = sidesOf(a, b);
  const Index c = sides.leftApex, d = sides.rightApex;
  const bool bc = isFeature(b, c), ca = isFeature(c, a), ad = isFeature(a, d), db = isFeature(d, b);
  faces_[sides.left] = {{c, d, b}, {false, db, bc}, faces_[sides.left].source};
  faces_[sides.right] = {{d, c, a}, {false, ca, ad}, faces_[sides.right].source};
  removeFace(a, sides.left);
  removeFace(b, sides.right);
  around_[c].push_back(sides.right);
  around_[d].push_back(sides.left);
}

}  // namespace sherd
