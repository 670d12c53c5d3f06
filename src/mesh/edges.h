// The edges of a mesh, with the number of triangles that use each.
#pragma once

#include <sherd/mesh.h>

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

namespace sherd {

/// An edge from its vertex of lower index to that of higher index.
struct EdgeUse {
  std::uint32_t low = 0, high = 0;
  std::size_t forward = 0, backward = 0;  ///< triangles that use it from low to high, and reverse
};

/// Edges by what is wrong with them.
struct EdgeDefects {
  std::size_t boundary = 0;     ///< of one triangle
  std::size_t nonManifold = 0;  ///< of more than two
  std::size_t misoriented = 0;  ///< of two that use it in the same direction
  std::size_t unbalanced = 0;   ///< openEdges: those of all kinds but non-manifold ones that are
                                ///< used equally often in both directions
};
[[nodiscard]] EdgeDefects edgeDefects(const TriangleMesh& mesh);

/// Returns "3 boundary edges and 1 misoriented edge"; empty if there are none.
[[nodiscard]] std::string textOf(const EdgeDefects& defects);

/// Calls visit(EdgeUse) for every edge, by lower vertex, then by higher.  Half edges are put into
/// one bucket per lower vertex and sorted there, which is several times faster than sorting all of
/// them.
template <class Visit>
void forEachEdge(const TriangleMesh& mesh, Visit visit) {
  std::vector<std::size_t> bucket(mesh.vertices.size() + 1,
                                  0);  // [v]..[v+1]: half edges whose lower end is v
  const auto forEachHalfEdge = [&](auto&& use) {
    for (const glm::uvec3& t : mesh.triangles) {
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t from = t[i], to = t[(i + 1) % 3];
        assert(from < mesh.vertices.size());
        if (from != to) use(std::min(from, to), std::max(from, to), from < to);
      }
    }
  };
  forEachHalfEdge([&](std::uint32_t low, std::uint32_t, bool) { ++bucket[low + 1]; });
  std::partial_sum(bucket.begin(), bucket.end(), bucket.begin());

  std::vector<std::uint64_t> halfEdges(bucket.back());  // higher vertex << 1 | forward
  std::vector<std::size_t> end(bucket.begin(), bucket.end() - 1);
  forEachHalfEdge([&](std::uint32_t low, std::uint32_t high, bool forward) {
    halfEdges[end[low]++] = std::uint64_t{high} << 1 | (forward ? 1u : 0u);
  });
  for (std::size_t v = 0; v + 1 < bucket.size(); ++v) {
    std::sort(halfEdges.begin() + static_cast<std::ptrdiff_t>(bucket[v]),
              halfEdges.begin() + static_cast<std::ptrdiff_t>(bucket[v + 1]));
    for (std::size_t i = bucket[v]; i < bucket[v + 1];) {
      const std::uint64_t high = halfEdges[i] >> 1;
      std::size_t uses[2] = {0, 0};
      for (; i < bucket[v + 1] && halfEdges[i] >> 1 == high; ++i) ++uses[halfEdges[i] & 1];
      visit(EdgeUse{static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(high), uses[1],
                    uses[0]});
    }
  }
}

}  // namespace sherd
