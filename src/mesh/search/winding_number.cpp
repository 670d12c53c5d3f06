// The winding number of a mesh around a point, as a sum of solid angles.
#include "mesh/search/winding_number.h"

#include <numbers>

#include "mesh/search/solid_angles.h"

namespace sherd {

double windingNumber(const TriangleMesh& mesh, const glm::dvec3& point) {
  SolidAngles angles;
  for (const glm::uvec3& t : mesh.triangles) {
    angles.add({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]}, point);
  }
  return angles.sum() / (4.0 * std::numbers::pi);
}

}  // namespace sherd
