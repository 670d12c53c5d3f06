// Updates connectivity under edge collapses.
#include "remesh/decimate/edge_collapse.h"

#include <algorithm>
#include <iterator>

#include "base/sort_unique.h"

namespace sherd {

CollapsingMesh::CollapsingMesh(const LabeledComplex& complex)
    : faces_(complex.faces),
      around_(complex.vertices.size()),
      labels_(complex.labels),
      left_(std::size_t{labels_} + 1, 0) {
  for (Index f = 0; f < faces_.size(); ++f) {
    if (faces_[f].corner.x == faces_[f].corner.y) continue;  // collapsed before
    for (int k = 0; k < 3; ++k) around_[faces_[f].corner[k]].push_back(f);
    for (const std::uint16_t label : {faces_[f].front, faces_[f].back}) {
      if (label <= labels_) ++left_[label];
    }
  }
}

std::uint64_t CollapsingMesh::region(Index f) const {
  const ComplexFace& face = faces_[f];
  const bool isBetween = face.back >= 1 && (face.back <= labels_ || labels_ == 0);
  return std::uint64_t{face.chart} << 33 | std::uint64_t{isBetween} << 32 |
         std::uint64_t{face.front} << 16 | (isBetween ? face.back : face.neighbor);
}

std::vector<CollapsingMesh::Index> CollapsingMesh::neighbors(Index v) const {
  std::vector<Index> found;
  found.reserve(2 * around_[v].size());
  for (const Index f : around_[v]) {
    for (int k = 0; k < 3; ++k) {
      if (faces_[f].corner[k] != v) found.push_back(faces_[f].corner[k]);
    }
  }
  sortUnique(found);
  return found;
}

std::vector<CollapsingMesh::Index> CollapsingMesh::neighborsOn(std::uint16_t label, Index v) const {
  std::vector<Index> found;
  for (const Index f : around_[v]) {
    if (!faces_[f].isOf(label)) continue;
    for (int k = 0; k < 3; ++k) {
      if (faces_[f].corner[k] != v) found.push_back(faces_[f].corner[k]);
    }
  }
  sortUnique(found);
  return found;
}

bool CollapsingMesh::isBoundary(Index a, Index b) const {
  std::size_t n = 0;
  std::uint64_t first = 0;
  for (const Index f : around_[a]) {
    if (!has(f, b)) continue;
    if (n++ == 0) first = region(f);
    if (region(f) != first) return true;
  }
  return n != 2;
}

int CollapsingMesh::boundaryEdges(Index v) const {
  const std::uint64_t first = region(around_[v].front());
  if (labels_ > 0 && std::all_of(around_[v].begin(), around_[v].end(),
                                 [&](Index f) { return region(f) == first; })) {
    return 0;
  }
  int count = 0;
  for (const Index n : neighbors(v)) count += isBoundary(v, n);
  return count;
}

std::vector<std::uint16_t> CollapsingMesh::labelsAt(Index a, Index b) const {
  std::vector<std::uint16_t> found;
  for (const Index f : around_[a]) {
    if (!has(f, b)) continue;
    for (const std::uint16_t label : {faces_[f].front, faces_[f].back}) {
      if (label >= 1 && label <= labels_) found.push_back(label);
    }
  }
  sortUnique(found);
  return found;
}

bool CollapsingMesh::keepsLink(Index a, Index b) const {
  const std::vector<Index> na = neighbors(a), nb = neighbors(b);
  std::vector<Index> common;
  std::set_intersection(na.begin(), na.end(), nb.begin(), nb.end(), std::back_inserter(common));
  std::size_t faces = 0;
  for (const Index f : around_[b]) {
    if (has(f, a)) {
      ++faces;
      continue;
    }
    // The face would be one that is there, of a tetrahedron.
    const glm::uvec3& t = faces_[f].corner;
    const auto isOwn = [&](Index v) {
      return v == b || std::binary_search(common.begin(), common.end(), v);
    };
    if (!isOwn(t.x) || !isOwn(t.y) || !isOwn(t.z)) continue;
    const bool isThere = std::any_of(around_[a].begin(), around_[a].end(), [&](Index g) {
      return (t.x == b || has(g, t.x)) && (t.y == b || has(g, t.y)) && (t.z == b || has(g, t.z));
    });
    if (isThere) return false;
  }
  return faces > 0 && common.size() == faces;
}

bool CollapsingMesh::keepsTopology(Index a, Index b) const {
  if (labels_ == 0 && !keepsLink(a, b)) return false;
  std::vector<std::uint16_t> labels;
  for (const Index v : {a, b}) {
    for (const Index f : around_[v]) {
      for (const std::uint16_t label : {faces_[f].front, faces_[f].back}) {
        if (label >= 1 && label <= labels_) labels.push_back(label);
      }
    }
  }
  sortUnique(labels);
  for (const std::uint16_t label : labels) {
    const std::vector<Index> na = neighborsOn(label, a), nb = neighborsOn(label, b);
    if (na.empty() || nb.empty()) continue;                          // the surface has one end only
    if (!std::binary_search(na.begin(), na.end(), b)) return false;  // would touch itself
    std::vector<Index> common;
    std::set_intersection(na.begin(), na.end(), nb.begin(), nb.end(), std::back_inserter(common));
    if (common.size() != 2) return false;
    if (na.size() == 3 && nb.size() == 3) return false;  // a tetrahedron
  }
  if (!isBoundary(a, b)) return true;
  // A face with three boundary edges is the last of its region, or of a branch of it.
  return std::none_of(around_[a].begin(), around_[a].end(), [&](Index f) {
    if (!has(f, b)) return false;
    const glm::uvec3& t = faces_[f].corner;
    const Index c = t.x != a && t.x != b ? t.x : (t.y != a && t.y != b ? t.y : t.z);
    return isBoundary(a, c) && isBoundary(b, c);
  });
}

void CollapsingMesh::collapse(Index a, Index b) {
  for (const Index f : around_[b]) {
    glm::uvec3& t = faces_[f].corner;
    if (!has(f, a)) {
      for (int k = 0; k < 3; ++k) {
        if (t[k] == b) t[k] = a;
      }
      around_[a].push_back(f);
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      if (t[k] != b) std::erase(around_[t[k]], f);
    }
    t = glm::uvec3(0);
    for (const std::uint16_t label : {faces_[f].front, faces_[f].back}) {
      if (label <= labels_) --left_[label];
    }
  }
  around_[b].clear();
}

}  // namespace sherd
