// Area and shape of single triangles.
#pragma once

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

namespace sherd {

/// The cosine of a tenth of a degree: normals at a smaller angle are those of one plane.
inline constexpr double kSamePlaneCosine = 1.0 - 1.523e-6;

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
  const double longest =
      std::max({glm::distance(t[0], t[1]), glm::distance(t[1], t[2]), glm::distance(t[2], t[0])});
  return twiceArea <= share * longest * longest;
}

}  // namespace sherd
