// Triangulates a triangle around a polygon with the polygon's sides, and finds what is inside.
#include "remesh/decimate/facet_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <span>

#include "base/sort_unique.h"
#include "intersect/triangulate.h"
#include "remesh/face_edges.h"

namespace sherd {
namespace {

// Vertices, ascending, and their numbers among the points of a triangulation, after its corners.
std::uint32_t numberOf(std::uint32_t vertex, std::span<const std::uint32_t> used) {
  return static_cast<std::uint32_t>(
      3 + (std::lower_bound(used.begin(), used.end(), vertex) - used.begin()));
}

// Returns the polygon of three sides if these are a triangle's.
std::optional<FacetPolygon> triangleOf(std::span<const Side> sides) {
  if (sides.size() != 3) return {};
  for (const auto& [second, third] : {std::array<std::size_t, 2>{1, 2}, {2, 1}}) {
    if (sides[0].to == sides[second].from && sides[second].to == sides[third].from) {
      return FacetPolygon{.isMade = true,
                          .triangles = {{sides[0].from, sides[second].from, sides[third].from}}};
    }
  }
  return {};
}

// Returns the corners of a triangle around all points, and the points, in the facet's plane.
std::vector<TrianglePoint> enclosingTriangle(const Facets::Plane& plane, const FacetChains& chains,
                                             std::span<const std::uint32_t> used) {
  const glm::dvec3 n = plane.normal;
  const glm::dvec3 away = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(away, n)), v = glm::cross(n, u);
  std::vector<TrianglePoint> points(3);
  double reach = 0.0;
  for (const std::uint32_t vertex : used) {
    const glm::dvec3 apart = chains.position(vertex) - plane.point;
    const glm::dvec3 flat(glm::dot(apart, u), glm::dot(apart, v), 0.0);
    reach = std::max({reach, std::abs(flat.x), std::abs(flat.y)});
    points.push_back({ExactPoint(flat), 0});
  }
  const std::array<glm::dvec3, 3> corner{glm::dvec3(-4, -4, 0), glm::dvec3(8, -4, 0),
                                         glm::dvec3(-4, 8, 0)};
  for (std::size_t k = 0; k < 3; ++k) {
    points[k] = {ExactPoint(reach * corner[k]), kCornerEdges[k]};
  }
  return points;
}

// Returns the sides that cross another or pass through a point, and coincident points.
FacetPolygon crossingOf(const Triangulation& all, std::span<const Side> sides,
                        std::span<const std::uint32_t> used) {
  FacetPolygon polygon;
  const auto add = [&](const Side& side) {
    polygon.chains.push_back(side.chain);
    polygon.vertices.insert(polygon.vertices.end(), {side.from, side.to});
  };
  for (const auto& [a, b] : all.crossing) {
    add(sides[a]);
    add(sides[b]);
  }
  for (const auto& [point, side] : all.onSegment) add(sides[side]);
  for (const auto& points : all.coincident) polygon.vertices.push_back(used[points[0] - 3]);
  sortUnique(polygon.chains);
  sortUnique(polygon.vertices);
  return polygon;
}

// Returns [triangles] whether each is inside the polygon: on the left of a side, or connected to
// one that is.  Nothing if one is on the right, too.
std::optional<std::vector<bool>> insideOf(const Triangulation& all,
                                          std::span<const std::array<std::uint32_t, 2>> segments,
                                          std::size_t points) {
  const FaceEdges edges(all.triangles, points);
  std::vector<bool> isInside(all.triangles.size(), false);
  std::vector<std::uint32_t> todo;
  const auto isLeft = [&](std::uint32_t t, int k) {
    return segments[all.segments[t][k]][0] == all.triangles[t][k];
  };
  for (std::uint32_t t = 0; t < all.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (all.segments[t][k] == Triangulation::kNone || !isLeft(t, k) || isInside[t]) continue;
      isInside[t] = true;
      todo.push_back(t);
    }
  }
  while (!todo.empty()) {
    const std::uint32_t t = todo.back();
    todo.pop_back();
    for (int k = 0; k < 3; ++k) {
      if (all.segments[t][k] != Triangulation::kNone) {
        if (!isLeft(t, k)) return {};
        continue;
      }
      const auto uses = edges.uses(edges.of(t)[static_cast<std::size_t>(k)]);
      if (uses.size() != 2) return {};  // the enclosing triangle's border
      const std::uint32_t other = uses[0].face == t ? uses[1].face : uses[0].face;
      if (isInside[other]) continue;
      isInside[other] = true;
      todo.push_back(other);
    }
  }
  return isInside;
}

}  // namespace

FacetPolygon polygonOf(std::uint32_t facet, std::span<const Side> sides, const FacetChains& chains,
                       const Facets::Plane& plane) {
  if (sides.empty()) return {.isMade = true};
  if (const std::optional<FacetPolygon> triangle = triangleOf(sides)) return *triangle;
  std::vector<std::uint32_t> used;
  for (const Side& side : sides) used.insert(used.end(), {side.from, side.to});
  sortUnique(used);
  const auto unmade = [&] {
    const auto own = chains.of(facet);
    return FacetPolygon{.chains = {own.begin(), own.end()}, .vertices = used};
  };
  if (plane.normal == glm::dvec3(0.0)) return unmade();  // of faces without area

  const std::vector<TrianglePoint> points = enclosingTriangle(plane, chains, used);
  std::vector<std::array<std::uint32_t, 2>> segments;
  for (const Side& side : sides) {
    segments.push_back({numberOf(side.from, used), numberOf(side.to, used)});
  }
  const Triangulation all = triangulate(points, segments);
  if (all.isFlat) return unmade();
  if (!all.isComplete()) return crossingOf(all, sides, used);
  const std::optional<std::vector<bool>> isInside = insideOf(all, segments, points.size());
  if (!isInside) return unmade();
  FacetPolygon polygon{.isMade = true};
  for (std::size_t t = 0; t < all.triangles.size(); ++t) {
    if (!(*isInside)[t]) continue;
    const glm::uvec3& corner = all.triangles[t];
    polygon.triangles.push_back({used[corner.x - 3], used[corner.y - 3], used[corner.z - 3]});
  }
  return polygon;
}

}  // namespace sherd
