// Fits a plane to the triangles of a contact.
#include "evaluate/cracks/contact_plane.h"

#include <glm/geometric.hpp>

#include "mesh/triangle_area.h"

namespace sherd {

ContactPlane contactPlane(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
  if (triangles.empty()) return {};
  const glm::dvec3 origin = mesh.vertices[mesh.triangles[triangles.front()].x];
  PlaneMoments moments;
  for (const std::uint32_t t : triangles) {
    auto corners = positionsOf(mesh.vertices, mesh.triangles[t]);
    for (glm::dvec3& corner : corners) corner -= origin;
    moments.add(corners);
  }
  ContactPlane result{moments.plane(), moments.area, 0.0};
  result.meanSquare = moments.meanSquare(result.plane);
  result.plane.offset += glm::dot(result.plane.normal, origin);
  return result;
}

}  // namespace sherd
