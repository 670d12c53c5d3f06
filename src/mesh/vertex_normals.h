// Normals of a mesh's vertices.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <vector>

namespace sherd {

/// A triangle's unit normal, or zero if it has no area, and the angles at its corners.
struct Corners {
  glm::dvec3 normal{0.0};
  std::array<double, 3> angle{};  ///< radians
  double twiceArea = 0.0;
};
[[nodiscard]] Corners cornersOf(const TriangleMesh& mesh, const glm::uvec3& triangle);

/// Returns the normalized vector, or zero for a zero vector.
[[nodiscard]] glm::dvec3 unitOrZero(const glm::dvec3& v);

/// Returns [vertices] unit normals: the mean of the normals of the adjacent triangles, weighted by
/// their angles at the vertex; zero if these cancel.
///   source  Thurmer, Wuthrich, Computing vertex normals from polygonal facets, 1998
[[nodiscard]] std::vector<glm::dvec3> vertexNormals(const TriangleMesh& mesh);

}  // namespace sherd
