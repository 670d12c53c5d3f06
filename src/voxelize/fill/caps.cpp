// Triangles that close a mesh.
#include "voxelize/fill/caps.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "mesh/edges.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Triangulates a section of the loop by recursive halving: half of the triangles lie along the
// boundary and are as small as its edges, so a tree of them stays local.
void addHalves(std::uint32_t from, std::uint32_t to, TriangleMesh& caps) {
  if (to - from < 2) return;
  const std::uint32_t middle = from + (to - from) / 2;
  caps.triangles.emplace_back(from, middle, to);
  addHalves(from, middle, caps);
  addHalves(middle, to, caps);
}

}  // namespace

std::vector<std::vector<std::uint32_t>> openLoops(const TriangleMesh& mesh) {
  // Missing edges, sorted by their first vertex.  As many enter each vertex as leave it, so a walk
  // along them ends only where it started.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> missing;
  forEachEdge(mesh, [&](const EdgeUse& edge) {
    for (std::size_t n = edge.backward; n < edge.forward; ++n)
      missing.emplace_back(edge.high, edge.low);
    for (std::size_t n = edge.forward; n < edge.backward; ++n)
      missing.emplace_back(edge.low, edge.high);
  });
  std::vector<std::vector<std::uint32_t>> loops;
  if (missing.empty()) return loops;
  std::sort(missing.begin(), missing.end());
  std::vector<std::size_t> next(mesh.vertices.size() + 1, 0);  // first edge not visited yet
  for (const auto& edge : missing) ++next[edge.first + 1];
  for (std::size_t v = 0; v + 1 < next.size(); ++v) next[v + 1] += next[v];
  const std::vector<std::size_t> first = next;

  std::vector<std::uint32_t> path;
  std::vector<std::uint32_t> onPath(mesh.vertices.size(), kNone);  // index in `path`
  for (std::uint32_t start = 0; start < mesh.vertices.size(); ++start) {
    while (next[start] < first[start + 1]) {
      path.assign(1, start);
      onPath[start] = 0;
      while (!path.empty() && next[path.back()] < first[path.back() + 1]) {
        const std::uint32_t to = missing[next[path.back()]++].second;
        if (onPath[to] == kNone) {
          onPath[to] = static_cast<std::uint32_t>(path.size());
          path.push_back(to);
          continue;
        }
        // A loop is closed: it is removed from the path, which continues from the loop's start.
        const std::size_t from = onPath[to];
        // Two opposite edges enclose nothing.
        if (path.size() - from > 2) {
          loops.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(from), path.end());
        }
        for (std::size_t i = from + 1; i < path.size(); ++i) onPath[path[i]] = kNone;
        path.resize(from + 1);
      }
      onPath[start] = kNone;
    }
  }
  return loops;
}

TriangleMesh loopCaps(const TriangleMesh& mesh) {
  TriangleMesh caps;
  for (const std::vector<std::uint32_t>& loop : openLoops(mesh)) {
    const auto first = static_cast<std::uint32_t>(caps.vertices.size());
    for (const std::uint32_t vertex : loop) caps.vertices.push_back(mesh.vertices[vertex]);
    addHalves(first, first + static_cast<std::uint32_t>(loop.size()) - 1, caps);
  }
  return caps;
}

TriangleMesh coneCaps(const TriangleMesh& mesh) {
  TriangleMesh caps;
  forEachEdge(mesh, [&](const EdgeUse& edge) {
    if ((edge.forward + edge.backward) % 2 == 0) return;
    if (caps.vertices.empty()) {
      glm::dvec3 sum(0.0);
      for (const glm::dvec3& v : mesh.vertices) sum += v;
      caps.vertices.push_back(sum / static_cast<double>(mesh.vertices.size()));
    }
    const auto first = static_cast<std::uint32_t>(caps.vertices.size());
    caps.vertices.push_back(mesh.vertices[edge.low]);
    caps.vertices.push_back(mesh.vertices[edge.high]);
    caps.triangles.emplace_back(first, first + 1, 0);
  });
  return caps;
}

}  // namespace sherd
