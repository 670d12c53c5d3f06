// Chains edges between regions into loops.
#include "surface/region_edges.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

namespace sherd {
namespace {

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

RegionLoops RegionEdges::loops() && {
  std::sort(edges_.begin(), edges_.end());
  // A boundary edge of a region has no face of the same region in the opposite direction.
  std::map<int, std::multimap<std::uint32_t, std::uint32_t>> next;
  for (const Edge& edge : edges_) {
    if (!std::binary_search(edges_.begin(), edges_.end(),
                            Edge{edge.neighbor, edge.to, edge.from})) {
      next[edge.neighbor].emplace(edge.from, edge.to);
    }
  }
  RegionLoops curves;
  for (auto& [neighbor, ofRegion] : next) curves[neighbor] = loopsOf(std::move(ofRegion));
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
