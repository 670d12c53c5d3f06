// Topology of a mesh: open and non-manifold edges, connected components.
#include <sherd/mesh.h>

#include <algorithm>
#include <numeric>

#include "mesh/edges.h"

namespace sherd {

std::size_t openEdges(const TriangleMesh& mesh) {
  std::size_t count = 0;
  forEachEdge(mesh, [&](const EdgeUse& edge) { count += edge.forward != edge.backward; });
  return count;
}

std::size_t nonManifoldEdges(const TriangleMesh& mesh) {
  std::size_t count = 0;
  forEachEdge(mesh, [&](const EdgeUse& edge) { count += edge.forward != 1 || edge.backward != 1; });
  return count;
}

MeshComponents meshComponents(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());  // union-find over the vertices
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const glm::uvec3& t : mesh.triangles) {
    const std::uint32_t x = root(t.x), y = root(t.y), z = root(t.z), low = std::min({x, y, z});
    parent[x] = parent[y] = parent[z] = low;
  }

  constexpr std::uint32_t kUnnumbered = 0xffffffffu;
  MeshComponents out;
  out.ofTriangle.reserve(mesh.triangles.size());
  std::vector<std::uint32_t> number(mesh.vertices.size(), kUnnumbered);
  for (const glm::uvec3& t : mesh.triangles) {
    std::uint32_t& n = number[root(t.x)];
    if (n == kUnnumbered) n = out.count++;
    out.ofTriangle.push_back(n);
  }
  return out;
}

}  // namespace sherd
