// Reversal of a mesh's orientation.
#pragma once

#include <sherd/mesh.h>

#include <utility>

namespace sherd {

/// Returns the same surface with the opposite orientation.
[[nodiscard]] inline TriangleMesh flippedOrientation(TriangleMesh mesh) {
  for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

}  // namespace sherd
