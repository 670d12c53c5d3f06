// The borders of contacts.
#include <sherd/fragments.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

namespace sherd {
namespace {

// An edge of a face, which faces a fragment.
struct Edge {
  std::uint16_t facing;
  std::uint32_t from, to;

  auto key() const { return std::tuple(facing, from, to); }
  bool operator<(const Edge& other) const { return key() < other.key(); }
};

// All edges of faces towards fragments whose ends have faces towards something else too: those
// between two regions are among them.
std::vector<Edge> edgesAtBorders(const Fragment& fragment) {
  constexpr std::uint32_t kNone = 0xffffffffu, kSeveral = 0xfffffffeu;
  std::vector<std::uint32_t> faces(fragment.mesh.vertices.size(), kNone);  // what the vertex's face
  for (std::size_t t = 0; t < fragment.facing.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& known = faces[fragment.mesh.triangles[t][k]];
      if (known != fragment.facing[t]) known = known == kNone ? fragment.facing[t] : kSeveral;
    }
  }
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < fragment.facing.size(); ++t) {
    if (fragment.facing[t] == 0) continue;
    const glm::uvec3& corner = fragment.mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = corner[k], to = corner[(k + 1) % 3];
      if (faces[from] == kSeveral && faces[to] == kSeveral) {
        edges.push_back({fragment.facing[t], from, to});
      }
    }
  }
  return edges;
}

using Curves = std::vector<std::vector<std::uint32_t>>;

// As many edges lead to a vertex as lead from it, so that a walk ends where it began.
Curves walked(std::multimap<std::uint32_t, std::uint32_t> onwards) {
  Curves curves;
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

}  // namespace

std::map<int, Curves> rimCurves(const Fragment& fragment) {
  std::vector<Edge> edges = edgesAtBorders(fragment);
  std::sort(edges.begin(), edges.end());
  // A region's rim has no face of the region in the opposite direction.
  std::map<int, std::multimap<std::uint32_t, std::uint32_t>> onwards;
  for (const Edge& edge : edges) {
    if (!std::binary_search(edges.begin(), edges.end(), Edge{edge.facing, edge.to, edge.from})) {
      onwards[edge.facing].emplace(edge.from, edge.to);
    }
  }
  std::map<int, Curves> curves;
  for (auto& [facing, ofRegion] : onwards) curves[facing] = walked(std::move(ofRegion));
  return curves;
}

}  // namespace sherd
