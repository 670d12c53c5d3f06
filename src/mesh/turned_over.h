// A mesh seen from its other side.
#pragma once

#include <sherd/mesh.h>

#include <utility>

namespace sherd {

/// The same surface, oriented the other way.
[[nodiscard]] inline TriangleMesh turnedOver(TriangleMesh mesh) {
  for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

}  // namespace sherd
