// Points where edges cross triangles, with their exact positions.
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "intersect/exact_point.h"

namespace sherd {

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
