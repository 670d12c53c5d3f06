// All crossings between a mesh and its cutters.
#include "intersect/find_crossings.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

#include "base/cancel_flag.h"
#include "base/sort_unique.h"
#include "mesh/search/boxes.h"
#include "mesh/search/triangle_tree.h"

namespace sherd {
namespace {

// Triangles of the surface that a task processes.
constexpr std::size_t kBlock = 1024;

PairTriangle pairTriangle(const std::vector<glm::dvec3>& vertices,
                          const std::vector<glm::uvec3>& triangles, std::uint32_t i) {
  const glm::uvec3& t = triangles[i];
  return {i, t, {vertices[t.x], vertices[t.y], vertices[t.z]}};
}

void addCrossings(const PairTriangle& s, const Cutters& cutters, const TriangleTree& tree,
                  CrossedPairs& found) {
  const Box box = boxOf(s.corner);
  if (!meet(box, tree.box())) return;
  std::vector<std::uint32_t> near = tree.meeting(box);
  for (std::uint32_t& c : near) c = tree.source(c);
  std::sort(near.begin(), near.end());
  for (const std::uint32_t c : near) {
    const TrianglePair pair = meetingOf(s, pairTriangle(cutters.vertices, cutters.triangles, c));
    switch (pair.kind) {
      case TrianglePair::Kind::apart:
        break;
      case TrianglePair::Kind::crossing:
        found.pairs.push_back({s.index, c, pair.from, pair.to});
        break;
      case TrianglePair::Kind::degenerate:
        if (pair.isSurfaceFlat) {
          found.flat.push_back(s.index);
        } else {
          found.degenerate.insert(found.degenerate.end(), pair.cutterVertices.begin(),
                                  pair.cutterVertices.end());
        }
        break;
    }
  }
}

}  // namespace

CrossedPairs findCrossings(const TriangleMesh& surface, const Cutters& cutters,
                           const Progress* progress) {
  CrossedPairs all;
  const TriangleTree tree(TriangleMesh{cutters.vertices, cutters.triangles});
  if (tree.empty()) return all;
  const std::size_t count = surface.triangles.size(), blocks = (count + kBlock - 1) / kBlock;
  std::vector<CrossedPairs> found(blocks);
  CancelFlag cancel(progress);
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    if (cancel.isSet()) return;
    const std::size_t end = std::min(count, (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i) {
      const auto s = static_cast<std::uint32_t>(i);
      addCrossings(pairTriangle(surface.vertices, surface.triangles, s), cutters, tree,
                   found[block]);
    }
  });
  cancel.throwIfSet();
  for (const CrossedPairs& part : found) {
    all.pairs.insert(all.pairs.end(), part.pairs.begin(), part.pairs.end());
    all.degenerate.insert(all.degenerate.end(), part.degenerate.begin(), part.degenerate.end());
    all.flat.insert(all.flat.end(), part.flat.begin(), part.flat.end());
  }
  sortUnique(all.degenerate);
  sortUnique(all.flat);
  return all;
}

}  // namespace sherd
