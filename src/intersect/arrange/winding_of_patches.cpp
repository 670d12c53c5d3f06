// Winding numbers by exact rays, one for each patch.
#include "intersect/arrange/winding_of_patches.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>
#include <utility>

#include "base/cancel_flag.h"
#include "base/union_find.h"
#include "intersect/homogeneous_point.h"
#include "mesh/largest_axis.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

using Corners = std::array<glm::dvec3, 3>;

struct HalfEdge {
  std::uint32_t low = 0, high = 0;
  std::uint32_t part = 0;
  int uses = 0;  // positive from low to high
};

// Returns [parts] the first part of each one's patch.
std::optional<std::vector<std::uint32_t>> patchesOf(std::span<const ArrangedTriangle> parts) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * parts.size());
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    const auto count = static_cast<int>(parts[p].multiplicity);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = parts[p].corner[k], to = parts[p].corner[(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), p, from < to ? count : -count});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.part) < std::tie(b.low, b.high, b.part);
  });
  UnionFind patches(parts.size());
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    int sum = 0;
    for (end = begin; end < edges.size() && edges[end].low == edges[begin].low &&
                      edges[end].high == edges[begin].high;
         ++end) {
      sum += edges[end].uses;
    }
    if (sum != 0) return std::nullopt;
    if (end - begin == 2) patches.unite(edges[begin].part, edges[begin + 1].part);
  }
  return std::move(patches).all();
}

class Rays {
 public:
  Rays(const TriangleMesh& mesh, const TriangleTree& tree, const PointSet& points)
      : mesh_(mesh), tree_(tree), points_(points) {}

  [[nodiscard]] int windingInFrontOf(const ArrangedTriangle& part) const;

 private:
  // Returns the winding number just beyond a point along an axis; nothing if the line through it
  // meets an edge.
  [[nodiscard]] std::optional<int> beyond(const ExactPoint& p, int axis) const;
  [[nodiscard]] Corners cornersOf(std::uint32_t t) const {
    return positionsOf(mesh_.vertices, mesh_.triangles[t]);
  }

  const TriangleMesh& mesh_;
  const TriangleTree& tree_;
  const PointSet& points_;
};

// How a line along an axis meets a triangle.
enum class Meeting { none, edge, frontFirst, backFirst };

Meeting meetingOf(const Corners& t, const ExactPoint& p, int axis) {
  const std::array<ExactPoint, 3> corner{ExactPoint(t[0]), ExactPoint(t[1]), ExactPoint(t[2])};
  int least = 1, most = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = orientation(corner[k], corner[(k + 1) % 3], p, axis);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  if (least > 0) return Meeting::backFirst;
  if (most < 0) return Meeting::frontFirst;
  if (least < 0 && most > 0) return Meeting::none;
  // On an edge, or on a triangle that is seen as a line, which may end before the point: both are
  // rare, and another point may be clear of them.
  return Meeting::edge;
}

std::optional<int> Rays::beyond(const ExactPoint& p, int axis) const {
  Box box = tree_.box();
  for (int k = 0; k < 3; ++k) {
    box.min[k] = std::nextafter(p.rounded[k], -INFINITY);
    if (k != axis) box.max[k] = std::nextafter(p.rounded[k], INFINITY);
  }
  int winding = 0;
  for (const std::uint32_t near : tree_.meeting(box)) {
    const Corners t = cornersOf(tree_.source(near));
    const Meeting meeting = meetingOf(t, p, axis);
    if (meeting == Meeting::none) continue;
    if (meeting == Meeting::edge) return std::nullopt;
    const int leaves = meeting == Meeting::backFirst ? 1 : -1;
    if (orientation(t, p) * leaves < 0) winding += leaves;
  }
  return winding;
}

int Rays::windingInFrontOf(const ArrangedTriangle& part) const {
  const std::array<ExactPoint, 3> corner{points_.at(part.corner.x), points_.at(part.corner.y),
                                         points_.at(part.corner.z)};
  const Corners source = cornersOf(part.source);
  const glm::dvec3 normal = glm::cross(source[1] - source[0], source[2] - source[0]);
  const int first = largestAxis(normal);
  for (int attempt = 0;; ++attempt) {
    const int axis = (first + attempt / 8) % 3;
    // Triangles that are thin to the last digits need another axis.
    const int side = orientation(corner[0], corner[1], corner[2], axis);
    if (side == 0) {
      attempt += 7;
      continue;
    }
    // Other points of the part: primes, so that no two are on a line with a corner.
    constexpr std::array<int, 8> kWeights{31, 37, 23, 41, 13, 43, 7, 47};
    const auto weight = [&](int i) { return kWeights[static_cast<std::size_t>(attempt + i) % 8]; };
    const ExactPoint p = weightedMean(corner, {weight(0), weight(1) + attempt, weight(2)});
    const std::optional<int> winding = beyond(p, axis);
    if (winding) return side > 0 ? *winding : *winding - static_cast<int>(part.multiplicity);
  }
}

}  // namespace

std::optional<std::vector<int>> windingInFront(const TriangleMesh& mesh, const TriangleTree& tree,
                                               std::span<const ArrangedTriangle> parts,
                                               const PointSet& points, const Progress* progress) {
  const std::optional<std::vector<std::uint32_t>> patchOf = patchesOf(parts);
  if (!patchOf) return std::nullopt;
  const auto sizeOf = [&](const ArrangedTriangle& part) {
    const glm::dvec3& a = points.rounded(part.corner.x);
    return glm::length(
        glm::cross(points.rounded(part.corner.y) - a, points.rounded(part.corner.z) - a));
  };
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> largest(parts.size(), kNone);  // by patch
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    std::uint32_t& best = largest[(*patchOf)[p]];
    if (best == kNone || sizeOf(parts[p]) > sizeOf(parts[best])) best = p;
  }
  const Rays rays(mesh, tree, points);
  std::vector<int> ofPatch(parts.size(), 0);
  for (std::uint32_t patch = 0; patch < parts.size(); ++patch) {
    if (largest[patch] == kNone) continue;
    throwIfCancelled(progress);
    ofPatch[patch] = rays.windingInFrontOf(parts[largest[patch]]);
  }
  std::vector<int> all(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) all[p] = ofPatch[(*patchOf)[p]];
  return all;
}

}  // namespace sherd
