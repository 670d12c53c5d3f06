// Normals that a file gives for the corners of its faces.
#include "formats/mesh/normals.h"

#include <utility>

namespace sherd {
namespace {

// Rounding to single precision changes the length of a unit vector by less.
constexpr double kRounding = 1e-6;

constexpr glm::vec3 kNoNormal(0.0f);

// Returns the unit vector of a normal, or kNoNormal if it has no direction.
glm::vec3 unitNormal(const glm::vec3& normal) {
  const glm::dvec3 v(normal);
  const double length = glm::length(v);
  if (!std::isfinite(length) || !(length > 0.0)) return kNoNormal;
  if (std::abs(length - 1.0) <= kRounding) return normal;
  return glm::vec3(v / length);
}

// Returns the unit normal of a triangle; (0, 1, 0) if it has no area.
glm::vec3 normalOf(const RawMesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 &a = mesh.vertices[t.x], &b = mesh.vertices[t.y], &c = mesh.vertices[t.z];
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  const double length = glm::length(cross);
  const bool isUsable = length > 0.0 && std::isfinite(length);
  return isUsable ? glm::vec3(cross / length) : glm::vec3(0.0f, 1.0f, 0.0f);
}

}  // namespace

void completeNormals(RawMesh& mesh) {
  auto& normals = mesh.attributes.normals;
  bool isAnyGiven = false;
  for (auto& corners : normals) {
    for (glm::vec3& normal : corners) {
      normal = unitNormal(normal);
      isAnyGiven |= normal != kNoNormal;
    }
  }
  if (!isAnyGiven) {
    std::exchange(normals, {});
    return;
  }
  for (std::size_t t = 0; t < normals.size(); ++t) {
    for (glm::vec3& normal : normals[t]) {
      if (normal == kNoNormal) normal = normalOf(mesh, mesh.triangles[t]);
    }
  }
}

}  // namespace sherd
