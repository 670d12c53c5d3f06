// Normals of a mesh's vertices.
#include "mesh/vertex_normals.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace sherd {

glm::dvec3 unitOrZero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : glm::dvec3(0.0);
}

Corners cornersOf(const TriangleMesh& mesh, const glm::uvec3& triangle) {
  const glm::dvec3& a = mesh.vertices[triangle.x];
  const glm::dvec3& b = mesh.vertices[triangle.y];
  const glm::dvec3& c = mesh.vertices[triangle.z];
  const glm::dvec3 ab = b - a, bc = c - b, ca = a - c;
  const glm::dvec3 across = glm::cross(ab, -ca);
  const double length = glm::length(across);
  if (!(length > 0.0)) return {};
  return {across / length,
          {std::atan2(length, glm::dot(ab, -ca)), std::atan2(length, glm::dot(bc, -ab)),
           std::atan2(length, glm::dot(ca, -bc))}};
}

std::vector<glm::dvec3> vertexNormals(const TriangleMesh& mesh) {
  std::vector<glm::dvec3> normals(mesh.vertices.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : mesh.triangles) {
    const Corners corners = cornersOf(mesh, t);
    for (int k = 0; k < 3; ++k) {
      normals[t[k]] += corners.angle[static_cast<std::size_t>(k)] * corners.normal;
    }
  }
  for (glm::dvec3& normal : normals) normal = unitOrZero(normal);
  return normals;
}

}  // namespace sherd
