// Charts: the regions of a mesh whose look has no seam.
#include "appearance/charts.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace sherd {
namespace {

// An edge of a triangle from its corner `corner` to the next, its ends in ascending order.
struct Edge {
  std::uint32_t low, high, triangle;
  std::uint8_t corner;
  bool ascending;

  auto key() const { return std::tie(low, high, triangle, corner); }
};

// Whether two corners of triangles look alike.
bool alike(const SurfaceLook& look, std::uint32_t a, std::size_t cornerA, std::uint32_t b,
           std::size_t cornerB) {
  return (look.texcoords.empty() || look.texcoords[a][cornerA] == look.texcoords[b][cornerB]) &&
         (look.colours.empty() || look.colours[a][cornerA] == look.colours[b][cornerB]);
}

bool belongTogether(const SurfaceLook& look, const Edge& a, const Edge& b) {
  if (a.ascending == b.ascending) return false;
  if (!look.material.empty() && look.material[a.triangle] != look.material[b.triangle]) {
    return false;
  }
  const std::size_t a0 = a.corner, a1 = (a0 + 1) % 3, b0 = b.corner, b1 = (b0 + 1) % 3;
  return alike(look, a.triangle, a0, b.triangle, b1) && alike(look, a.triangle, a1, b.triangle, b0);
}

// Calls with each two triangles' edges that are the same; of an edge of many triangles with
// neighbours in their order only, which keeps it cheap.
template <class Call>
void forEachPair(const std::vector<Edge>& edges, Call&& call) {
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < std::min(edges.size(), i + 4); ++j) {
      if (edges[j].low != edges[i].low || edges[j].high != edges[i].high) break;
      call(edges[i], edges[j]);
    }
  }
}

std::uint32_t rootOf(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

Charts charts(const TriangleMesh& mesh, const SurfaceLook& look) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), t, k, from < to});
    }
  }
  tbb::parallel_sort(edges.begin(), edges.end(),
                     [](const Edge& a, const Edge& b) { return a.key() < b.key(); });

  Charts out;
  out.of.resize(mesh.triangles.size());
  std::iota(out.of.begin(), out.of.end(), 0u);
  out.beyond.assign(mesh.triangles.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
  forEachPair(edges, [&](const Edge& a, const Edge& b) {
    std::uint32_t& beyondA = out.beyond[a.triangle][a.corner];
    std::uint32_t& beyondB = out.beyond[b.triangle][b.corner];
    if (beyondA != kNoTriangle || beyondB != kNoTriangle || !belongTogether(look, a, b)) return;
    beyondA = b.triangle;
    beyondB = a.triangle;
    const std::uint32_t rootA = rootOf(out.of, a.triangle), rootB = rootOf(out.of, b.triangle);
    out.of[std::max(rootA, rootB)] = std::min(rootA, rootB);
  });
  for (std::uint32_t t = 0; t < out.of.size(); ++t) out.of[t] = rootOf(out.of, t);
  forEachPair(edges, [&](const Edge& a, const Edge& b) {
    if (out.of[a.triangle] != out.of[b.triangle] ||
        out.beyond[a.triangle][a.corner] == b.triangle) {
      return;
    }
    out.ownSeam.push_back(a.triangle);
    out.ownSeam.push_back(b.triangle);
  });
  std::sort(out.ownSeam.begin(), out.ownSeam.end());
  out.ownSeam.erase(std::unique(out.ownSeam.begin(), out.ownSeam.end()), out.ownSeam.end());
  return out;
}

}  // namespace sherd
