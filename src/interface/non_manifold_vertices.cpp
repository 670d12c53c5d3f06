// Moves sheets of a surface apart where they touch.
#include "interface/non_manifold_vertices.h"

#include <sherd/labels.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

namespace sherd {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// How far a sheet is moved: voxels, and at most this share of the shortest edge there.
constexpr double kStep = 0.1;
constexpr double kMaxEdgeShare = 0.25;

// A second pass, because splitting a neighbor's sheets may make another split possible.
constexpr int kPasses = 2;

// A face at a non-manifold position: a quad, or a triangle that fills a gap.
struct Face {
  std::uint16_t label = 0, other = 0;
  std::vector<std::uint32_t> vertex;
  std::uint32_t partner = kNone;  // its other side, if that has a mesh
  InterfaceQuad* quad = nullptr;
};

class SheetSplitter {
 public:
  SheetSplitter(std::span<const std::uint32_t> nonManifold,
                std::span<std::vector<InterfaceQuad>> quads, InterfaceVertices& vertices)
      : vertices_(vertices) {
    std::vector<bool> isNonManifold(vertices.positionCount);
    for (const std::uint32_t positionId : nonManifold) isNonManifold[positionId] = true;
    const auto gather = [&](InterfaceQuad& quad) {
      const bool isNear = std::any_of(quad.vertex.begin(), quad.vertex.end(), [&](std::uint32_t v) {
        return isNonManifold[vertices_.positionId[v]];
      });
      if (!isNear || !hasMesh(quad.label)) return;
      add({quad.label, quad.other, {quad.vertex.begin(), quad.vertex.end()}, kNone, &quad});
      const auto added = static_cast<std::uint32_t>(faces_.size() - 1);
      if (added > 0 && arePartners(faces_[added - 1], faces_[added])) {
        faces_[added].partner = added - 1;
        faces_[added - 1].partner = added;
      }
    };
    for (std::vector<InterfaceQuad>& ofLeaf : quads) {
      for (InterfaceQuad& quad : ofLeaf) gather(quad);
    }
  }

  // Splits the sheets at a position as far as possible.
  void split(std::uint32_t positionId) {
    const auto here = verticesAt_.find(positionId);
    if (here == verticesAt_.end()) return;
    std::set<std::uint16_t> labels;
    for (const std::uint32_t v : here->second) labels.insert(labelOf(v));
    for (const std::uint16_t label : labels) {
      std::vector<std::pair<std::size_t, std::uint32_t>> sheets;  // small ones first
      for (const std::uint32_t v : here->second) {
        if (labelOf(v) == label) sheets.push_back({around_.at(v).size(), v});
      }
      std::sort(sheets.begin(), sheets.end());
      std::size_t left = sheets.size();
      for (const auto& [size, v] : sheets) left -= left > 1 && moveInwards(v);
    }
  }

  std::vector<InterfaceTriangle> finish() {
    std::vector<InterfaceTriangle> gaps;
    for (const Face& face : faces_) {
      if (face.quad) {
        std::copy(face.vertex.begin(), face.vertex.end(), face.quad->vertex.begin());
      } else {
        gaps.push_back({face.label, face.other, {face.vertex[0], face.vertex[1], face.vertex[2]}});
      }
    }
    return gaps;
  }

 private:
  // A face of the ring around a vertex, which is its corner `corner`.
  struct Spoke {
    std::uint32_t face = 0;
    std::size_t corner = 0;
  };

  // The partner's vertices, if a face of a ring has one: at the ring's middle, and at the ends of
  // the edges before and after the face.
  struct Beyond {
    std::uint32_t middle = kNone, before = kNone, after = kNone;
  };

  void add(Face face) {
    const auto number = static_cast<std::uint32_t>(faces_.size());
    for (const std::uint32_t v : face.vertex) {
      std::vector<std::uint32_t>& around = around_[v];
      if (around.empty()) verticesAt_[vertices_.positionId[v]].insert(v);
      around.push_back(number);
    }
    faces_.push_back(std::move(face));
  }

  std::uint16_t labelOf(std::uint32_t v) const { return faces_[around_.at(v).front()].label; }

  bool arePartners(const Face& a, const Face& b) const {
    if (a.label != b.other || b.label != a.other) return false;
    for (std::size_t k = 0; k < 4; ++k) {
      if (vertices_.positionId[a.vertex[k]] != vertices_.positionId[b.vertex[(4 - k) % 4]])
        return false;
    }
    return true;
  }

  std::uint32_t cornerOf(const Spoke& spoke, std::size_t further) const {
    const std::vector<std::uint32_t>& vertex = faces_[spoke.face].vertex;
    return vertex[(spoke.corner + further) % vertex.size()];
  }
  std::uint32_t firstOf(const Spoke& spoke) const { return cornerOf(spoke, 1); }
  std::uint32_t lastOf(const Spoke& spoke) const {
    return cornerOf(spoke, faces_[spoke.face].vertex.size() - 1);
  }

  // The faces around a vertex, counter-clockwise; empty if they are not one ring.
  std::vector<Spoke> ringOf(std::uint32_t v) const {
    std::map<std::uint32_t, Spoke> byFirst;
    const std::vector<std::uint32_t>& around = around_.at(v);
    for (const std::uint32_t f : around) {
      const std::vector<std::uint32_t>& vertex = faces_[f].vertex;
      const Spoke spoke{
          f, static_cast<std::size_t>(std::find(vertex.begin(), vertex.end(), v) - vertex.begin())};
      byFirst[firstOf(spoke)] = spoke;
    }
    std::vector<Spoke> ring{byFirst.begin()->second};
    while (ring.size() <= around.size()) {
      const auto next = byFirst.find(lastOf(ring.back()));
      if (next == byFirst.end()) return {};
      if (next->second.face == ring.front().face) break;
      ring.push_back(next->second);
    }
    return ring.size() <= around.size() ? ring : std::vector<Spoke>{};
  }

  std::uint32_t vertexAt(const Face& face, std::uint32_t positionId) const {
    return *std::find_if(face.vertex.begin(), face.vertex.end(),
                         [&](std::uint32_t v) { return vertices_.positionId[v] == positionId; });
  }

  Beyond beyond(const Spoke& spoke, std::uint32_t v) const {
    const std::uint32_t partner = faces_[spoke.face].partner;
    if (partner == kNone) return {};
    const Face& face = faces_[partner];
    return {vertexAt(face, vertices_.positionId[v]),
            vertexAt(face, vertices_.positionId[firstOf(spoke)]),
            vertexAt(face, vertices_.positionId[lastOf(spoke)])};
  }

  std::uint16_t otherOf(const Spoke& spoke) const {
    const std::uint16_t other = faces_[spoke.face].other;
    return hasMesh(other) ? other : std::uint16_t{0};
  }

  // The new position of a vertex: into its label, against the mean normal of the faces around it.
  glm::dvec3 inwards(std::uint32_t v, const std::vector<Spoke>& ring) const {
    const glm::dvec3& from = vertices_.at[v];
    glm::dvec3 normal(0.0), mean(0.0);
    double shortest = 1.0;
    for (const Spoke& spoke : ring) {
      const glm::dvec3 a = vertices_.at[firstOf(spoke)] - from,
                       b = vertices_.at[lastOf(spoke)] - from;
      const glm::dvec3 n = glm::cross(a, b);
      const double length = glm::length(n);
      if (length > 0.0) normal += n / length;
      mean += a;
      shortest = std::min(shortest, glm::length(a));
    }
    const double count = static_cast<double>(ring.size());
    const glm::dvec3 way = glm::length(normal) > 0.2 * count ? -normal : mean;
    const double length = glm::length(way);
    if (length == 0.0) return from;
    return from + std::min(kStep, kMaxEdgeShare * shortest) / length * way;
  }

  // The ring of a vertex to be moved, from the beginning of a sector on.  A sector is a run of
  // faces with one label on the other side.
  struct MovedRing {
    std::vector<Spoke> ring;
    std::vector<Beyond> outside;  // [i] of face i
    std::vector<bool> hasGap;     // [i] sectors meet between faces i and i + 1

    std::size_t size() const { return ring.size(); }
    std::size_t next(std::size_t i) const { return (i + 1) % size(); }
    std::size_t previous(std::size_t i) const { return (i + size() - 1) % size(); }
  };

  MovedRing movedRingOf(std::uint32_t v) const {
    MovedRing p{ringOf(v), {}, {}};
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (otherOf(p.ring[p.previous(i)]) == otherOf(p.ring[i])) continue;
      std::rotate(p.ring.begin(), p.ring.begin() + static_cast<std::ptrdiff_t>(i), p.ring.end());
      break;
    }
    for (std::size_t i = 0; i < p.size(); ++i) {
      p.outside.push_back(beyond(p.ring[i], v));
      p.hasGap.push_back(otherOf(p.ring[i]) != otherOf(p.ring[p.next(i)]));
    }
    return p;
  }

  // True if one neighbor has faces on both sides of an edge of the ring.
  bool isWithinSector(const MovedRing& p, std::size_t spoke) const {
    return !p.hasGap[spoke] && otherOf(p.ring[spoke]) != 0;
  }

  bool canMove(std::uint32_t v, const MovedRing& p) const {
    // A ring with an edge twice passes through a neighbor and cannot be moved.
    std::set<std::uint32_t> ends;
    for (const Spoke& spoke : p.ring) ends.insert(vertices_.positionId[lastOf(spoke)]);
    if (p.size() != around_.at(v).size() || ends.size() != p.size()) return false;
    // A neighbor with two sectors would touch itself.
    std::set<std::uint16_t> neighbors;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const std::uint16_t other = otherOf(p.ring[i]);
      if (other != 0 && p.hasGap[p.previous(i)] && !neighbors.insert(other).second) return false;
    }
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!isWithinSector(p, i)) continue;
      const Beyond &one = p.outside[i], &two = p.outside[p.next(i)];
      if (one.after == two.before ? one.middle != two.middle
                                  : !canMerge(one.after, two.before, one.middle) ||
                                        !canMerge(one.middle, two.middle, one.middle)) {
        return false;
      }
    }
    return true;
  }

  // Merges the neighbors' sheets that lie on both sides of an edge of the ring.
  //   return  vertices whose faces may become several rings
  std::set<std::uint32_t> mergeAlongSpokes(std::uint32_t v, MovedRing& p) {
    std::set<std::uint32_t> merged;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Beyond one = p.outside[i], two = p.outside[p.next(i)];
      if (!isWithinSector(p, i) || one.after == two.before) continue;
      merge(two.before, one.after);
      if (two.middle != one.middle) merge(two.middle, one.middle);
      merged.insert({one.after, one.middle});
      for (std::size_t k = 0; k < p.size(); ++k) p.outside[k] = beyond(p.ring[k], v);
    }
    return merged;
  }

  // Moves a vertex to a new position, and adds a vertex of each neighbor there.
  bool moveInwards(std::uint32_t v) {
    MovedRing p = movedRingOf(v);
    if (!canMove(v, p)) return false;
    const glm::dvec3 to = inwards(v, p.ring);
    if (to == vertices_.at[v]) return false;
    const std::set<std::uint32_t> merged = mergeAlongSpokes(v, p);
    const std::uint32_t positionId = vertices_.positionCount++;
    verticesAt_[vertices_.positionId[v]].erase(v);
    verticesAt_[positionId].insert(v);
    vertices_.at[v] = to;
    vertices_.positionId[v] = positionId;
    std::vector<std::uint32_t> moved(p.size(), kNone);  // [i] the neighbor's vertex, moved
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (p.outside[i].middle == kNone) continue;
      moved[i] = i == 0 || p.hasGap[i - 1] ? newVertex(to, positionId) : moved[i - 1];
      replace(faces_[p.ring[i].face].partner, p.outside[i].middle, moved[i]);
    }
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (p.hasGap[i]) fillGap(p, i, moved);
    }
    for (const std::uint32_t u : merged) splitRings(u);
    return true;
  }

  // Adds both sides of the triangle between the old position, the new one and the end of a spoke.
  void fillGap(const MovedRing& p, std::size_t spoke, const std::vector<std::uint32_t>& moved) {
    const std::size_t next = p.next(spoke);
    const Beyond &before = p.outside[spoke], &after = p.outside[next];
    const std::uint16_t one = faces_[p.ring[spoke].face].other,
                        two = faces_[p.ring[next].face].other;
    const std::size_t first = faces_.size();
    if (moved[spoke] != kNone) {
      add({one, two, {before.middle, before.after, moved[spoke]}, kNone, nullptr});
    }
    if (moved[next] != kNone) {
      add({two, one, {moved[next], after.before, after.middle}, kNone, nullptr});
    }
    if (faces_.size() == first + 2) {
      faces_[first].partner = static_cast<std::uint32_t>(first + 1);
      faces_[first + 1].partner = static_cast<std::uint32_t>(first);
    }
  }

  std::set<std::uint32_t> neighborsOf(std::uint32_t v) const {
    std::set<std::uint32_t> found;
    for (const std::uint32_t f : around_.at(v)) {
      const std::vector<std::uint32_t>& vertex = faces_[f].vertex;
      const std::size_t n = vertex.size();
      const std::size_t at =
          static_cast<std::size_t>(std::find(vertex.begin(), vertex.end(), v) - vertex.begin());
      found.insert({vertex[(at + 1) % n], vertex[(at + n - 1) % n]});
    }
    return found;
  }

  // True if no vertex except `one` is adjacent to both vertices.
  bool canMerge(std::uint32_t a, std::uint32_t b, std::uint32_t one) const {
    if (a == b) return true;
    const std::set<std::uint32_t> ofA = neighborsOf(a), ofB = neighborsOf(b);
    return std::none_of(ofA.begin(), ofA.end(),
                        [&](std::uint32_t v) { return v != one && ofB.count(v) > 0; });
  }

  // Merges two vertices of a label at one position.
  void merge(std::uint32_t from, std::uint32_t to) {
    const std::vector<std::uint32_t> faces = around_.at(from);
    for (const std::uint32_t f : faces) replace(f, from, to);
  }

  // Gives each ring around a vertex except one its own vertex.
  void splitRings(std::uint32_t u) {
    const auto around = around_.find(u);
    if (around == around_.end() || around->second.empty()) return;
    const std::vector<Spoke> ring = ringOf(u);
    if (ring.empty() || ring.size() == around->second.size()) return;
    const std::uint32_t other = newVertex(vertices_.at[u], vertices_.positionId[u]);
    for (const Spoke& spoke : ring) replace(spoke.face, u, other);
    splitRings(u);
  }

  std::uint32_t newVertex(const glm::dvec3& at, std::uint32_t positionId) {
    vertices_.at.push_back(at);
    vertices_.positionId.push_back(positionId);
    return static_cast<std::uint32_t>(vertices_.at.size() - 1);
  }

  void replace(std::uint32_t f, std::uint32_t from, std::uint32_t to) {
    std::vector<std::uint32_t>& vertex = faces_[f].vertex;
    std::replace(vertex.begin(), vertex.end(), from, to);
    std::vector<std::uint32_t>& around = around_[from];
    around.erase(std::find(around.begin(), around.end(), f));
    if (around.empty()) verticesAt_[vertices_.positionId[from]].erase(from);
    std::vector<std::uint32_t>& aroundNew = around_[to];
    if (aroundNew.empty()) verticesAt_[vertices_.positionId[to]].insert(to);
    aroundNew.push_back(f);
  }

  InterfaceVertices& vertices_;
  std::vector<Face> faces_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> around_;   // by vertex
  std::unordered_map<std::uint32_t, std::set<std::uint32_t>> verticesAt_;  // by positionId
};

}  // namespace

std::vector<InterfaceTriangle> splitNonManifoldVertices(std::span<const std::uint32_t> nonManifold,
                                                        std::span<std::vector<InterfaceQuad>> quads,
                                                        InterfaceVertices& vertices) {
  if (nonManifold.empty()) return {};
  SheetSplitter splitter(nonManifold, quads, vertices);
  for (int pass = 0; pass < kPasses; ++pass) {
    for (const std::uint32_t positionId : nonManifold) splitter.split(positionId);
  }
  return splitter.finish();
}

}  // namespace sherd
