// The coordinate axis along which a vector is longest.
#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace sherd {

/// Returns 0..2, the first of equal ones.  Along it a triangle with this normal is projected with
/// the largest area.
[[nodiscard]] inline int largestAxis(const glm::dvec3& v) {
  const glm::dvec3 size = glm::abs(v);
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

}  // namespace sherd
