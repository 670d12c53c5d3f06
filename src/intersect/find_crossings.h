// All crossings between a mesh and its cutters.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstdint>
#include <vector>

#include "intersect/mesh_cut.h"
#include "intersect/triangle_pair.h"

namespace sherd {

/// Two triangles that cross.
struct CrossedPair {
  std::uint32_t s = 0, c = 0;
  CrossingKey from, to;  ///< as in TrianglePair
};

struct CrossedPairs {
  std::vector<CrossedPair> pairs;  ///< by s, then by c
  // Ascending without repetition:
  std::vector<std::uint32_t> degenerate;  ///< vertices of cutters
  std::vector<std::uint32_t> flat;        ///< triangles of the surface
};

///   throws  Error(cancelled)
[[nodiscard]] CrossedPairs findCrossings(const TriangleMesh& surface, const Cutters& cutters,
                                         const Progress* progress);

}  // namespace sherd
