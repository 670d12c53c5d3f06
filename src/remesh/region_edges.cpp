// Chains edges between regions into loops.
#include "remesh/region_edges.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace sherd {
namespace {

using Curves = std::vector<std::vector<std::uint32_t>>;

// The directed edges of one region's boundary, ascending, each taken once.
class BoundaryEdges {
 public:
  void add(std::uint32_t from, std::uint32_t to) { edges_.push_back({from, to}); }

  // Chains the edges into loops.  Each vertex has as many incoming as outgoing edges, so a walk
  // ends where it began.
  Curves loops() {
    Curves curves;
    for (Edge& first : edges_) {
      if (first.isTaken) continue;
      std::vector<std::uint32_t>& curve = curves.emplace_back();
      for (Edge* at = &first; at != nullptr; at = nextFrom(at->to)) {
        at->isTaken = true;
        curve.push_back(at->from);
      }
    }
    return curves;
  }

 private:
  struct Edge {
    std::uint32_t from, to;
    bool isTaken = false;
  };

  // Returns the first edge from a vertex that is left, or null.
  Edge* nextFrom(std::uint32_t vertex) {
    auto at = std::ranges::lower_bound(edges_, vertex, {}, &Edge::from);
    while (at != edges_.end() && at->from == vertex && at->isTaken) ++at;
    return at != edges_.end() && at->from == vertex ? &*at : nullptr;
  }

  std::vector<Edge> edges_;
};

}  // namespace

RegionLoops RegionEdges::loops() && {
  std::sort(edges_.begin(), edges_.end());
  // A boundary edge of a region has no face of the same region in the opposite direction.
  std::map<int, BoundaryEdges> boundaries;
  for (const Edge& edge : edges_) {
    if (!std::binary_search(edges_.begin(), edges_.end(),
                            Edge{edge.neighbor, edge.to, edge.from})) {
      boundaries[edge.neighbor].add(edge.from, edge.to);
    }
  }
  RegionLoops curves;
  for (auto& [neighbor, ofRegion] : boundaries) curves[neighbor] = ofRegion.loops();
  return curves;
}

std::map<int, double> lengthsOf(const RegionLoops& loops, std::span<const glm::dvec3> vertices) {
  std::map<int, double> lengths;
  for (const auto& [neighbor, curves] : loops) {
    double& length = lengths[neighbor];
    for (const std::vector<std::uint32_t>& curve : curves) {
      for (std::size_t i = 0; i < curve.size(); ++i) {
        length += glm::length(vertices[curve[(i + 1) % curve.size()]] - vertices[curve[i]]);
      }
    }
  }
  return lengths;
}

}  // namespace sherd
