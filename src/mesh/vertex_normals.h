// Normals of a mesh's vertices.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <vector>

namespace sherd {

/// A triangle's unit normal, or zero where it has no area, and its angles at its corners.
struct Corners {
  glm::dvec3 normal{0.0};
  std::array<double, 3> angle{};  ///< radians
};
[[nodiscard]] Corners cornersOf(const TriangleMesh& mesh, const glm::uvec3& triangle);

/// The vector's direction, or zero.
[[nodiscard]] glm::dvec3 unitOrZero(const glm::dvec3& v);

/// [vertices] A vertex's normal is the mean of those of the faces round it, weighted by their
/// angles there; unit length, or zero where these cancel.
///   source  Thurmer, Wuthrich, Computing vertex normals from polygonal facets, 1998
[[nodiscard]] std::vector<glm::dvec3> vertexNormals(const TriangleMesh& mesh);

}  // namespace sherd
