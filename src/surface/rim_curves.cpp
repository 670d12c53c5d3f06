// The borders of contacts.
#include <sherd/fragments.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

namespace sherd {

std::vector<std::vector<std::uint32_t>> rimCurves(const Fragment& fragment, int other) {
  // A border vertex has faces of the region and others.
  std::vector<std::uint8_t> kinds(fragment.mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < fragment.facing.size(); ++t) {
    const std::uint8_t kind = fragment.facing[t] == other ? 1 : 2;
    for (int k = 0; k < 3; ++k) kinds[fragment.mesh.triangles[t][k]] |= kind;
  }
  // Edges of the region that no other face of it has in the opposite direction.
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < fragment.facing.size(); ++t) {
    if (fragment.facing[t] != other) continue;
    const glm::uvec3& corner = fragment.mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = corner[k], to = corner[(k + 1) % 3];
      if (kinds[from] == 3 && kinds[to] == 3) edges.emplace_back(from, to);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::multimap<std::uint32_t, std::uint32_t> onwards;
  for (const Edge& edge : edges) {
    if (!std::binary_search(edges.begin(), edges.end(), Edge{edge.second, edge.first})) {
      onwards.insert(edge);
    }
  }
  // As many lead to a vertex as lead from it, so that a walk ends where it began.
  std::vector<std::vector<std::uint32_t>> curves;
  while (!onwards.empty()) {
    std::vector<std::uint32_t>& curve = curves.emplace_back();
    for (auto at = onwards.begin(); at != onwards.end(); at = onwards.find(curve.back())) {
      if (curve.empty()) curve.push_back(at->first);
      curve.push_back(at->second);
      onwards.erase(at);
    }
    curve.pop_back();  // the first again
  }
  return curves;
}

}  // namespace sherd
