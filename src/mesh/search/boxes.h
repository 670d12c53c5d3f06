// Boxes of triangles.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <glm/common.hpp>

namespace sherd {

[[nodiscard]] inline Box boxOf(const std::array<glm::dvec3, 3>& t) {
  return {glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2]))};
}

[[nodiscard]] inline Box widened(const Box& box, double by) { return {box.min - by, box.max + by}; }

/// Whether two boxes have a point in common.
[[nodiscard]] inline bool meet(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && a.min.y <= b.max.y && a.min.z <= b.max.z && a.max.x >= b.min.x &&
         a.max.y >= b.min.y && a.max.z >= b.min.z;
}

}  // namespace sherd
