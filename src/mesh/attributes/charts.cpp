// Charts: the regions of a mesh whose surface attributes have no seam.
#include "mesh/attributes/charts.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/union_find.h"

namespace sherd {
namespace {

// An edge of a triangle from its corner `corner` to the next, its ends in ascending order.
struct Edge {
  std::uint32_t low, high, triangle;
  std::uint8_t corner;
  bool ascending;

  auto key() const { return std::tie(low, high, triangle, corner); }
};

// Whether two corners of triangles have the same attributes.
bool haveSameAttributes(const SurfaceAttributes& attributes, std::uint32_t a, std::size_t cornerA,
                        std::uint32_t b, std::size_t cornerB) {
  return (attributes.texcoords.empty() ||
          attributes.texcoords[a][cornerA] == attributes.texcoords[b][cornerB]) &&
         (attributes.colors.empty() ||
          attributes.colors[a][cornerA] == attributes.colors[b][cornerB]);
}

// Whether two triangles have the same attributes along their edge.
bool haveSameAttributes(const SurfaceAttributes& attributes, const Edge& a, const Edge& b) {
  if (!attributes.material.empty() &&
      attributes.material[a.triangle] != attributes.material[b.triangle]) {
    return false;
  }
  const std::size_t a0 = a.corner, a1 = (a0 + 1) % 3, nextB = (b.corner + 1u) % 3;
  const std::size_t b0 = a.ascending == b.ascending ? b.corner : nextB;
  const std::size_t b1 = a.ascending == b.ascending ? nextB : b.corner;
  return haveSameAttributes(attributes, a.triangle, a0, b.triangle, b0) &&
         haveSameAttributes(attributes, a.triangle, a1, b.triangle, b1);
}

// Calls `call` for pairs of triangle edges with the same ends.  Each is paired with the next three
// in sorted order only, which bounds the cost of an edge of many triangles.
template <class Call>
void forEachPair(const std::vector<Edge>& edges, Call&& call) {
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < std::min(edges.size(), i + 4); ++j) {
      if (edges[j].low != edges[i].low || edges[j].high != edges[i].high) break;
      call(edges[i], edges[j]);
    }
  }
}

}  // namespace

Charts charts(const TriangleMesh& mesh) {
  const SurfaceAttributes& attributes = mesh.attributes;
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
  UnionFind sets(mesh.triangles.size());
  out.neighbors.assign(mesh.triangles.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
  forEachPair(edges, [&](const Edge& a, const Edge& b) {
    std::uint32_t& neighborA = out.neighbors[a.triangle][a.corner];
    std::uint32_t& neighborB = out.neighbors[b.triangle][b.corner];
    if (neighborA != kNoTriangle || neighborB != kNoTriangle || a.ascending == b.ascending ||
        !haveSameAttributes(attributes, a, b)) {
      return;
    }
    neighborA = b.triangle;
    neighborB = a.triangle;
    sets.unite(a.triangle, b.triangle);
  });
  out.ids = std::move(sets).all();
  forEachPair(edges, [&](const Edge& a, const Edge& b) {
    const std::uint32_t beyondA = out.neighbors[a.triangle][a.corner];
    const bool isOpen =
        beyondA == kNoTriangle || out.neighbors[b.triangle][b.corner] == kNoTriangle;
    if (isOpen && !haveSameAttributes(attributes, a, b)) {
      out.seams.push_back({{a.triangle, b.triangle}, {a.corner, b.corner}});
    }
    if (out.ids[a.triangle] != out.ids[b.triangle] || beyondA == b.triangle) return;
    out.selfSeam.push_back(a.triangle);
    out.selfSeam.push_back(b.triangle);
  });
  std::sort(out.selfSeam.begin(), out.selfSeam.end());
  out.selfSeam.erase(std::unique(out.selfSeam.begin(), out.selfSeam.end()), out.selfSeam.end());
  return out;
}

}  // namespace sherd
