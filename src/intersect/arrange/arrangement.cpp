// Finds in which points and lines triangles meet, and groups those of one plane.
//   source  Zhou, Grinspun, Zorin, Jacobson: Mesh Arrangements for Solid Geometry, 2016
#include "intersect/arrange/arrangement.h"

#include <algorithm>
#include <cassert>
#include <glm/geometric.hpp>
#include <utility>

#include "base/cancel_flag.h"
#include "base/sort_unique.h"
#include "base/union_find.h"
#include "intersect/predicates.h"
#include "mesh/largest_axis.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

using Corners = std::array<glm::dvec3, 3>;

// Whether a point in the plane of a triangle is in it or on its border.
bool isWithin(const glm::dvec3& p, const Corners& t) {
  const ExactPoint point(p);
  const std::array<ExactPoint, 3> corner{ExactPoint(t[0]), ExactPoint(t[1]), ExactPoint(t[2])};
  const int first = largestAxis(glm::cross(t[1] - t[0], t[2] - t[0]));
  for (int i = 0; i < 3; ++i) {  // more than one only where the triangle is thin to the last digits
    const int axis = (first + i) % 3;
    const int side = orientation(corner[0], corner[1], corner[2], axis);
    if (side == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      if (side * orientation(corner[k], corner[(k + 1) % 3], point, axis) < 0) return false;
    }
    return true;
  }
  return false;
}

// Whether a line that crosses the plane of a triangle passes through it or its border.
bool passes(const glm::dvec3& a, const glm::dvec3& b, const Corners& t) {
  int least = 1, most = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = orientation(a, b, t[k], t[(k + 1) % 3]);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least >= 0 || most <= 0;
}

class Intersections {
 public:
  Intersections(std::span<const glm::dvec3> vertices, std::span<const glm::uvec3> triangles,
                PointSet& points)
      : vertices_(vertices),
        triangles_(triangles),
        points_(points),
        plane_(triangles.size()),
        lines_(triangles.size()),
        single_(triangles.size()) {}

  void add(const std::array<std::uint32_t, 2>& pair);

  // Divides the triangles of the plane that is named by its first triangle.
  // Returns arrangePlane's failure.
  std::string divide(std::span<const std::uint32_t> ofPlane, std::vector<ArrangedTriangle>& out,
                     const Progress* progress);

  [[nodiscard]] std::uint32_t planeOf(std::uint32_t triangle) { return plane_.find(triangle); }

 private:
  using Sides = std::array<int, 3>;

  [[nodiscard]] Corners cornersOf(std::uint32_t t) const {
    return positionsOf(vertices_, triangles_[t]);
  }
  [[nodiscard]] static Sides sidesOf(const Corners& s, const Corners& t) {
    return {orientation(t[0], t[1], t[2], s[0]), orientation(t[0], t[1], t[2], s[1]),
            orientation(t[0], t[1], t[2], s[2])};
  }
  // Adds the points where the border of s meets t.
  void addEnds(std::uint32_t s, const Sides& sides, const Corners& t,
               std::vector<std::uint32_t>& ends);

  std::span<const glm::dvec3> vertices_;
  std::span<const glm::uvec3> triangles_;
  PointSet& points_;
  UnionFind plane_;                                 // triangles of one plane that meet
  std::vector<std::vector<ArrangedLine>> lines_;    // [triangles]
  std::vector<std::vector<std::uint32_t>> single_;  // [triangles] points where another only touches
};

void Intersections::addEnds(std::uint32_t s, const Sides& sides, const Corners& t,
                            std::vector<std::uint32_t>& ends) {
  const glm::uvec3& corner = triangles_[s];
  for (int k = 0; k < 3; ++k) {
    const int side = sides[static_cast<std::size_t>(k)];
    if (side == 0) {
      if (isWithin(vertices_[corner[k]], t)) ends.push_back(corner[k]);
      continue;
    }
    if (side * sides[static_cast<std::size_t>((k + 1) % 3)] >= 0) continue;
    const auto [low, high] = std::minmax({corner[k], corner[(k + 1) % 3]});
    const std::array<glm::dvec3, 2> edge{vertices_[low], vertices_[high]};
    if (passes(edge[0], edge[1], t)) ends.push_back(points_.add(crossingPoint(edge, t)));
  }
}

void Intersections::add(const std::array<std::uint32_t, 2>& pair) {
  const auto& [s, t] = pair;
  const Corners ofS = cornersOf(s), ofT = cornersOf(t);
  const Sides sidesS = sidesOf(ofS, ofT);
  if (sidesS == Sides{0, 0, 0}) {
    plane_.unite(s, t);
    return;
  }
  // The two planes cross in a line.  Each triangle has a segment of it, both of whose ends are on
  // its border, and what they have in common ends where one of them does.
  std::vector<std::uint32_t> ends;
  addEnds(s, sidesS, ofT, ends);
  addEnds(t, sidesOf(ofT, ofS), ofS, ends);
  sortUnique(ends);
  assert(ends.size() <= 2);
  for (const std::uint32_t triangle : {s, t}) {
    if (ends.size() == 1) single_[triangle].push_back(ends[0]);
    if (ends.size() == 2) lines_[triangle].push_back({ends[0], ends[1]});
  }
}

std::string Intersections::divide(std::span<const std::uint32_t> ofPlane,
                                  std::vector<ArrangedTriangle>& out, const Progress* progress) {
  std::vector<PlaneTriangle> triangles;
  std::vector<ArrangedLine> lines;
  std::vector<std::uint32_t> single;
  for (const std::uint32_t t : ofPlane) {
    triangles.push_back({t, triangles_[t]});
    lines.insert(lines.end(), lines_[t].begin(), lines_[t].end());
    single.insert(single.end(), single_[t].begin(), single_[t].end());
  }
  return arrangePlane(triangles, std::move(lines), std::move(single), points_, out, progress);
}

}  // namespace

Arrangement arrangementOf(std::span<const glm::dvec3> vertices,
                          std::span<const glm::uvec3> triangles,
                          std::span<const std::array<std::uint32_t, 2>> pairs, PointSet& points,
                          std::vector<std::uint8_t>& isDivided, const Progress* progress) {
  constexpr std::size_t kOften = 256;  // how much is done between two looks at `progress`
  const auto shareOf = [](std::size_t i, std::size_t count) {
    return static_cast<double>(i) / static_cast<double>(count);
  };
  isDivided.assign(triangles.size(), 0);
  for (const auto& [s, t] : pairs) isDivided[s] = isDivided[t] = 1;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; isDivided[t] != 0 && k < 3; ++k) points.addVertex(triangles[t][k]);
  }
  Intersections intersections(vertices, triangles, points);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i % kOften == 0) reportProgress(progress, kUniteStage, 0.5 * shareOf(i, pairs.size()));
    intersections.add(pairs[i]);
  }
  Arrangement out;
  std::vector<std::array<std::uint32_t, 2>> planes;  // {plane, triangle}
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (isDivided[t] == 0) {
      out.parts.push_back({triangles[t], t});
    } else {
      planes.push_back({intersections.planeOf(t), t});
    }
  }
  std::sort(planes.begin(), planes.end());
  std::vector<std::uint32_t> own;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    own.push_back(planes[i][1]);
    if (i + 1 < planes.size() && planes[i + 1][0] == planes[i][0]) continue;
    reportProgress(progress, kUniteStage, 0.5 + 0.5 * shareOf(i, planes.size()));
    if (std::string failure = intersections.divide(own, out.parts, progress); !failure.empty()) {
      return {{}, std::move(failure)};
    }
    own.clear();
  }
  return out;
}

}  // namespace sherd
