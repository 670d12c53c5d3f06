// Concatenation of two meshes.
#pragma once

#include <sherd/mesh.h>

namespace sherd {

/// Returns a mesh with the vertices and triangles of both, which have no attributes; vertices are
/// not merged.
[[nodiscard]] inline TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& other) {
  const auto first = static_cast<glm::uint>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  mesh.triangles.reserve(mesh.triangles.size() + other.triangles.size());
  for (const glm::uvec3& t : other.triangles) mesh.triangles.push_back(t + first);
  return mesh;
}

}  // namespace sherd
