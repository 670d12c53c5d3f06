// Finds the charts of faces near seams, and continues them over the others.
#include "remesh/seam_charts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/union_find.h"
#include "mesh/attributes/seams.h"

namespace sherd {
namespace {

// Pairs of original faces that share an edge.
std::vector<std::array<std::uint32_t, 2>> adjacentFaces(const TriangleMesh& mesh) {
  struct Edge {
    std::uint32_t low, high, face;
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    for (int k = 0; k < 3 && mesh.neighborOf(f) == 0; ++k) {
      const std::uint32_t a = mesh.triangles[f][k], b = mesh.triangles[f][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), f});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::array<std::uint32_t, 2>> out;
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const Edge &a = edges[i - 1], &b = edges[i];
    if (a.low == b.low && a.high == b.high) out.push_back({a.face, b.face});
  }
  return out;
}

}  // namespace

std::vector<std::uint32_t> seamCharts(const TriangleMesh& mesh, const Seams& seams,
                                      const GridFrame& frame) {
  std::vector<std::uint32_t> charts(mesh.triangles.size(), 0);
  tbb::parallel_for(std::size_t{0}, charts.size(), [&](std::size_t f) {
    if (mesh.neighborOf(f) != 0) return;
    const glm::uvec3& t = mesh.triangles[f];
    const glm::dvec3 middle =
        frame.indexFromWorld((mesh.vertices[t.x] + mesh.vertices[t.y] + mesh.vertices[t.z]) / 3.0);
    if (!seams.isNear(middle, 0.0)) return;
    const std::uint32_t chart = seams.chartAt(middle);
    charts[f] = chart == kNoTriangle ? 0 : chart + 1;
  });
  const std::vector<std::array<std::uint32_t, 2>> pairs = adjacentFaces(mesh);
  UnionFind far(charts.size());
  for (const auto& [a, b] : pairs) {
    if (charts[a] == 0 && charts[b] == 0) far.unite(a, b);
  }
  const std::vector<std::uint32_t> group = std::move(far).all();
  std::vector<std::uint32_t> around(charts.size(), 0);  // [group] the lowest chart next to it
  for (const auto& [a, b] : pairs) {
    for (const auto& [own, other] : {std::pair(a, b), std::pair(b, a)}) {
      if (charts[own] != 0 || charts[other] == 0) continue;
      std::uint32_t& found = around[group[own]];
      found = found == 0 ? charts[other] : std::min(found, charts[other]);
    }
  }
  for (std::size_t f = 0; f < charts.size(); ++f) {
    if (charts[f] == 0 && mesh.neighborOf(f) == 0) charts[f] = around[group[f]];
  }
  return charts;
}

}  // namespace sherd
