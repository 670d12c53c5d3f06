// Corners of a mesh that have one normal.
#include "formats/mesh/creases.h"

#include <glm/geometric.hpp>
#include <utility>

#include "base/union_find.h"
#include "mesh/vertex_normals.h"
#include "remesh/face_edges.h"

namespace sherd {

std::vector<std::uint32_t> creaseGroups(const TriangleMesh& mesh) {
  UnionFind groups(3 * mesh.triangles.size());
  std::vector<glm::dvec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) normals.push_back(cornersOf(mesh, t).normal);
  const FaceEdges edges(mesh.triangles, mesh.vertices.size());
  for (std::size_t e = 0; e < edges.count(); ++e) {
    const auto uses = edges.uses(e);
    if (uses.size() != 2 || uses[0].isForward == uses[1].isForward) continue;
    const FaceEdges::Use &a = uses[0], &b = uses[1];
    if (mesh.neighborOf(a.face) != mesh.neighborOf(b.face)) continue;
    if (glm::dot(normals[a.face], normals[b.face]) < kCreaseCosine) continue;
    // They use the edge in opposite directions.
    groups.unite(3 * a.face + a.corner, 3 * b.face + (b.corner + 1u) % 3);
    groups.unite(3 * a.face + (a.corner + 1u) % 3, 3 * b.face + b.corner);
  }
  return std::move(groups).all();
}

}  // namespace sherd
