// Whether numbers are finite.
#pragma once

#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace sherd {

template <class Number>
[[nodiscard]] bool isFinite(const glm::vec<2, Number>& v) {
  return std::isfinite(v.x) && std::isfinite(v.y);
}

template <class Number>
[[nodiscard]] bool isFinite(const glm::vec<3, Number>& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Whether all coordinates are finite.  Zero times an infinite number is not a number, and a sum
/// with one is none, so that this takes no branches.
[[nodiscard]] inline bool areFinite(std::span<const glm::dvec3> vectors) {
  glm::dvec3 sum(0.0);
  for (const glm::dvec3& v : vectors) sum += 0.0 * v;
  return sum == glm::dvec3(0.0);
}

}  // namespace sherd
