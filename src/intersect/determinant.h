// The determinant of three differences, in any type of number.
#pragma once

#include <glm/vec3.hpp>

namespace sherd {

/// Returns |b-a, c-a, d-a|.
template <class Number>
[[nodiscard]] Number determinant(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                                 const glm::dvec3& d) {
  const auto from = [&a](const glm::dvec3& p, int axis) {
    return Number::difference(p[axis], a[axis]);
  };
  const Number bx = from(b, 0), by = from(b, 1), bz = from(b, 2);
  const Number cx = from(c, 0), cy = from(c, 1), cz = from(c, 2);
  return (by * cz - bz * cy) * from(d, 0) + (bz * cx - bx * cz) * from(d, 1) +
         (bx * cy - by * cx) * from(d, 2);
}

}  // namespace sherd
