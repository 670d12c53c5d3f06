// Points where edges cross triangles, with their exact positions.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <memory>

namespace sherd {

struct HomogeneousPoint;

/// A given vertex, the point where an edge crosses a triangle, or any other exact position.  Its
/// exact coordinates are within `error` of rounded + rest.
struct ExactPoint {
  glm::dvec3 rounded{0.0};  ///< the exact coordinates, rounded to nearest
  glm::dvec3 rest{0.0};
  glm::dvec3 error{0.0};
  bool isVertex = true;                                ///< then `rounded` is exact
  std::array<glm::dvec3, 2> edge{};                    ///< of a crossing
  std::array<glm::dvec3, 3> corner{};                  ///< of a crossing: of its triangle
  std::shared_ptr<const HomogeneousPoint> position{};  ///< of neither a vertex nor a crossing

  ExactPoint() = default;
  explicit ExactPoint(const glm::dvec3& vertex) : rounded(vertex) {}
};

/// Returns the point where an edge crosses a triangle's plane.
///   edge    on both sides of the plane
///   source  Dekker's double-word arithmetic in most cases, else exact
[[nodiscard]] ExactPoint crossingPoint(const std::array<glm::dvec3, 2>& edge,
                                       const std::array<glm::dvec3, 3>& corner);

/// Returns the exact sign of the area of the triangle pqr, seen against the direction of a
/// coordinate axis (0..2): 1 if p, q, r are counter-clockwise, 0 if they are on a line.
[[nodiscard]] int orientation(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r,
                              int axis);

/// Returns true if three points are exactly on a line.
[[nodiscard]] bool areCollinear(const std::array<glm::dvec3, 3>& points);

}  // namespace sherd
