// How the triangles of a mesh hang together: edges and components.
#include <sherd/mesh.h>

#include <algorithm>
#include <cassert>
#include <numeric>

namespace sherd {
namespace {

// Calls visit(forward, backward) for every edge: how often triangles run along it from its lower
// vertex to its higher one, and back.  Half edges are put into one bucket per lower vertex and
// sorted there, which is several times faster than sorting all of them.
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
      visit(uses[1], uses[0]);
    }
  }
}

}  // namespace

std::size_t openEdges(const TriangleMesh& mesh) {
  std::size_t count = 0;
  forEachEdge(mesh,
              [&](std::size_t forward, std::size_t backward) { count += forward != backward; });
  return count;
}

std::size_t nonManifoldEdges(const TriangleMesh& mesh) {
  std::size_t count = 0;
  forEachEdge(mesh, [&](std::size_t forward, std::size_t backward) {
    count += forward != 1 || backward != 1;
  });
  return count;
}

Components components(const TriangleMesh& mesh) {
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
  Components out;
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
