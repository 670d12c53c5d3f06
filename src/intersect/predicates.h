// Exact signs of determinants of points.
#pragma once

#include <glm/vec3.hpp>

namespace sherd {

/// Returns the exact sign of |b-a, c-a, d-a|: 1 if d is in front of the triangle abc, on the side
/// from which a, b, c are counter-clockwise, -1 behind it, 0 in its plane.
///   source  Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
///           Predicates, 1997 (the filter)
[[nodiscard]] int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                              const glm::dvec3& d);

}  // namespace sherd
