// Boundary loops of contacts.
#include <sherd/fragments.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

namespace sherd {
namespace {

// A directed edge of a fracture face.
struct Edge {
  std::uint16_t neighbor;
  std::uint32_t from, to;

  auto key() const { return std::tuple(neighbor, from, to); }
  bool operator<(const Edge& other) const { return key() < other.key(); }
};

// The edges of fracture faces whose two ends both have faces of several neighbors.  A superset of
// the edges between two regions.
std::vector<Edge> candidateEdges(const Fragment& fragment) {
  constexpr std::uint32_t kNone = 0xffffffffu, kSeveral = 0xfffffffeu;
  std::vector<std::uint32_t> seen(fragment.mesh.vertices.size(), kNone);  // by the vertex's faces
  for (std::size_t t = 0; t < fragment.mesh.neighbor.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& known = seen[fragment.mesh.triangles[t][k]];
      if (known != fragment.mesh.neighbor[t])
        known = known == kNone ? fragment.mesh.neighbor[t] : kSeveral;
    }
  }
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < fragment.mesh.neighbor.size(); ++t) {
    if (fragment.mesh.neighbor[t] == 0) continue;
    const glm::uvec3& corner = fragment.mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = corner[k], to = corner[(k + 1) % 3];
      if (seen[from] == kSeveral && seen[to] == kSeveral) {
        edges.push_back({fragment.mesh.neighbor[t], from, to});
      }
    }
  }
  return edges;
}

using Curves = std::vector<std::vector<std::uint32_t>>;

// Chains edges into loops.  Each vertex has as many incoming as outgoing edges, so a walk ends
// where it began.
Curves loopsOf(std::multimap<std::uint32_t, std::uint32_t> next) {
  Curves curves;
  while (!next.empty()) {
    std::vector<std::uint32_t>& curve = curves.emplace_back();
    for (auto at = next.begin(); at != next.end(); at = next.find(curve.back())) {
      if (curve.empty()) curve.push_back(at->first);
      curve.push_back(at->second);
      next.erase(at);
    }
    curve.pop_back();  // repeats the first vertex
  }
  return curves;
}

}  // namespace

std::map<int, Curves> boundaryLoops(const Fragment& fragment) {
  std::vector<Edge> edges = candidateEdges(fragment);
  std::sort(edges.begin(), edges.end());
  // A boundary edge of a region has no face of the same region in the opposite direction.
  std::map<int, std::multimap<std::uint32_t, std::uint32_t>> next;
  for (const Edge& edge : edges) {
    if (!std::binary_search(edges.begin(), edges.end(), Edge{edge.neighbor, edge.to, edge.from})) {
      next[edge.neighbor].emplace(edge.from, edge.to);
    }
  }
  std::map<int, Curves> curves;
  for (auto& [neighbor, ofRegion] : next) curves[neighbor] = loopsOf(std::move(ofRegion));
  return curves;
}

}  // namespace sherd
