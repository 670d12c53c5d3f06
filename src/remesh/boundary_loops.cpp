// Boundary loops of contacts.
#include <sherd/fragments.h>

#include "remesh/region_edges.h"

namespace sherd {

std::map<int, std::vector<std::vector<std::uint32_t>>> boundaryLoops(const Fragment& fragment) {
  const TriangleMesh& mesh = fragment.mesh;
  RegionsAtVertices regions(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.neighbor.size(); ++t) {
    for (int k = 0; k < 3; ++k) regions.add(mesh.triangles[t][k], mesh.neighbor[t]);
  }
  RegionEdges edges(regions);
  for (std::size_t t = 0; t < mesh.neighbor.size(); ++t) {
    const glm::uvec3& corner = mesh.triangles[t];
    if (mesh.neighbor[t] != 0) edges.add({corner.x, corner.y, corner.z}, mesh.neighbor[t]);
  }
  return std::move(edges).loops();
}

}  // namespace sherd
