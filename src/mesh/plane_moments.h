// The plane nearest to a set of triangles.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace sherd {

/// The points x with dot(normal, x) = offset.
struct FittedPlane {
  glm::dvec3 normal{0.0, 0.0, 1.0};  ///< unit
  double offset = 0.0;
};

/// Integrals of 1, x and x x^T over triangles.  Coordinates should be about a point near them.
struct PlaneMoments {
  double area = 0.0;
  glm::dvec3 first{0.0};
  glm::dmat3 second{0.0};

  void add(const std::array<glm::dvec3, 3>& triangle);
  void add(const PlaneMoments& other);

  /// Returns the plane through the centroid for which meanSquare is least.
  [[nodiscard]] FittedPlane plane() const;

  /// Returns the mean square distance from a plane, 0 without area.
  [[nodiscard]] double meanSquare(const FittedPlane& plane) const;
};

}  // namespace sherd
