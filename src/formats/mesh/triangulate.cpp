// Triangulates polygons.
#include "formats/mesh/triangulate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/vec2.hpp>
#include <numeric>

namespace sherd {
namespace {

// Simple polygons need a few ear tests per corner; beyond this the search stops, or hostile
// polygons would take minutes.
constexpr std::size_t kEarTestsPerCorner = 20;
constexpr std::size_t kMostCornersForEars = 5000;

// Twice the signed area of a triangle: > 0 if it is counter-clockwise.
double twiceArea(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Projects the polygon along the axis closest to its normal (Newell's), counter-clockwise.
std::vector<glm::dvec2> flattened(std::span<const glm::dvec3> vertices,
                                  std::span<const std::uint32_t> polygon) {
  const glm::dvec3 first = vertices[polygon[0]];
  glm::dvec3 normal(0.0);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = vertices[polygon[i]] - first;
    const glm::dvec3 b = vertices[polygon[(i + 1) % polygon.size()]] - first;
    normal +=
        glm::dvec3((a.y - b.y) * (a.z + b.z), (a.z - b.z) * (a.x + b.x), (a.x - b.x) * (a.y + b.y));
  }
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(normal[i]) > std::abs(normal[axis])) axis = i;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
  std::vector<glm::dvec2> points;
  points.reserve(polygon.size());
  for (const std::uint32_t index : polygon)
    points.emplace_back(sign * vertices[index][u], vertices[index][v]);
  return points;
}

bool isConvex(std::span<const glm::dvec2> points) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    if (twiceArea(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0.0) return false;
  return true;
}

}  // namespace

void triangulate(std::span<const glm::dvec3> vertices, std::span<const std::uint32_t> polygon,
                 std::vector<glm::uvec3>& triangles) {
  assert(polygon.size() >= 3);
  std::vector<std::uint32_t> corners(polygon.size());
  std::iota(corners.begin(), corners.end(), 0u);
  if (polygon.size() > 3 && polygon.size() <= kMostCornersForEars) {
    std::vector<glm::dvec2> points = flattened(vertices, polygon);
    const auto isEar = [&](std::size_t i) {
      const std::size_t n = points.size();
      const glm::dvec2 a = points[(i + n - 1) % n], b = points[i], c = points[(i + 1) % n];
      if (!(twiceArea(a, b, c) > 0.0)) return false;
      return std::none_of(points.begin(), points.end(), [&](glm::dvec2 p) {
        return p != a && p != b && p != c && twiceArea(a, b, p) >= 0.0 &&
               twiceArea(b, c, p) >= 0.0 && twiceArea(c, a, p) >= 0.0;
      });
    };
    std::size_t testsLeft = kEarTestsPerCorner * points.size();
    std::size_t ear = 0;  // the search continues at the last ear
    while (!isConvex(points)) {
      const std::size_t n = points.size();
      std::size_t tested = 0;
      while (tested < n && !isEar((ear + tested) % n)) ++tested;
      if (tested == n || tested >= testsLeft) break;  // it intersects itself: fan the rest
      testsLeft -= tested;
      ear = (ear + tested) % n;
      triangles.emplace_back(corners[(ear + n - 1) % n], corners[ear], corners[(ear + 1) % n]);
      points.erase(points.begin() + static_cast<std::ptrdiff_t>(ear));
      corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(ear));
    }
  }
  for (std::size_t i = 2; i < corners.size(); ++i)
    triangles.emplace_back(corners[0], corners[i - 1], corners[i]);
}

}  // namespace sherd
