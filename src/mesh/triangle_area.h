// Positions, area and shape of single triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace sherd {

/// The cosine of a tenth of a degree: normals at a smaller angle are those of one plane.
inline constexpr double kSamePlaneCosine = 1.0 - 1.523e-6;

/// Returns the positions of a triangle's corners.
[[nodiscard]] inline std::array<glm::dvec3, 3> positionsOf(std::span<const glm::dvec3> vertices,
                                                           const glm::uvec3& triangle) {
  return {vertices[triangle.x], vertices[triangle.y], vertices[triangle.z]};
}

[[nodiscard]] inline double longestEdge(const std::array<glm::dvec3, 3>& t) {
  return std::max(
      {glm::distance(t[0], t[1]), glm::distance(t[1], t[2]), glm::distance(t[2], t[0])});
}

/// Returns the normal of a triangle, of length twice its area.
[[nodiscard]] inline glm::dvec3 areaNormal(const std::array<glm::dvec3, 3>& t) {
  return glm::cross(t[1] - t[0], t[2] - t[0]);
}

[[nodiscard]] inline double areaOf(const std::array<glm::dvec3, 3>& t) {
  return 0.5 * glm::length(areaNormal(t));
}

/// Returns whether a triangle's height is at most a share of its longest edge.
///   twiceArea  of it
[[nodiscard]] inline bool isThin(const std::array<glm::dvec3, 3>& t, double twiceArea,
                                 double share) {
  const double longest = longestEdge(t);
  return twiceArea <= share * longest * longest;
}

}  // namespace sherd
