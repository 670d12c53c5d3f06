// Solid angles.
#include "mesh/winding_number.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace sherd {

double windingNumber(const TriangleMesh& mesh, const glm::dvec3& point) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.vertices[t.x] - point, b = mesh.vertices[t.y] - point,
                     c = mesh.vertices[t.z] - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc +
                                                         glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (2.0 * std::numbers::pi);
}

}  // namespace sherd
