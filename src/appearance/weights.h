// Barycentric coordinates.
#pragma once

#include <glm/vec3.hpp>

namespace sherd {

/// Returns the barycentric coordinates of the point of a triangle nearest to p in its plane,
/// clamped to 0..1; of a triangle without area, 1 at the corner nearest to p.
[[nodiscard]] glm::dvec3 weightsAt(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                                   const glm::dvec3& c);

}  // namespace sherd
