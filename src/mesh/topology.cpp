// Topology of a mesh: open and non-manifold edges, connected components.
#include <sherd/mesh.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "mesh/edges.h"

namespace sherd {

std::size_t openEdges(const TriangleMesh& mesh) {
  std::size_t count = 0;
  forEachEdge(mesh, [&](const EdgeUse& edge) { count += edge.forward != edge.backward; });
  return count;
}

EdgeDefects edgeDefects(const TriangleMesh& mesh) {
  EdgeDefects defects;
  forEachEdge(mesh, [&](const EdgeUse& edge) {
    const std::size_t uses = edge.forward + edge.backward;
    defects.boundary += uses == 1 ? 1u : 0u;
    defects.nonManifold += uses > 2 ? 1u : 0u;
    defects.misoriented += uses == 2 && edge.forward != 1 ? 1u : 0u;
    defects.unbalanced += edge.forward != edge.backward ? 1u : 0u;
  });
  return defects;
}

std::string textOf(const EdgeDefects& defects) {
  std::vector<std::string> kinds;
  for (const auto& [count, kind] : {std::pair{defects.boundary, " boundary edge"},
                                    std::pair{defects.nonManifold, " non-manifold edge"},
                                    std::pair{defects.misoriented, " misoriented edge"}}) {
    if (count > 0) kinds.push_back(std::to_string(count) + kind + (count == 1 ? "" : "s"));
  }
  std::string text;
  for (std::size_t i = 0; i < kinds.size(); ++i)
    text += (i == 0 ? "" : i + 1 == kinds.size() ? " and " : ", ") + kinds[i];
  return text;
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
