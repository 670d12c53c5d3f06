// Splits the crossed triangles of one mesh along their seams.
#pragma once

#include <sherd/progress.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "intersect/crossing_point.h"
#include "intersect/mesh_cut.h"
#include "intersect/triangle_pair.h"

namespace sherd {

/// One of the two meshes of a cut.
struct CutSide {
  const std::vector<glm::dvec3>& vertices;
  const std::vector<glm::uvec3>& triangles;
  bool isCutter = false;
  std::uint32_t firstVertex = 0;  ///< number of its first vertex in the cut
};

/// The crossing points of a cut.
struct CrossingPoints {
  std::vector<CrossingKey> keys;   ///< ascending
  std::vector<ExactPoint> points;  ///< [keys]
  std::uint32_t first = 0;         ///< number of the first one in the cut

  [[nodiscard]] const CrossingKey& key(std::uint32_t vertex) const { return keys[vertex - first]; }
};

struct SplitTriangles {
  std::vector<CutTriangle> parts;       ///< by source
  std::vector<std::uint8_t> isCrossed;  ///< [triangles] 0 or 1

  // What prevents the split, in no particular order:
  std::vector<std::array<std::uint32_t, 2>> crossingSeams;
  std::vector<std::uint32_t> degenerate;  ///< vertices of cutters
  std::vector<std::uint32_t> flat;        ///< triangles
};

///   cutters  the triangles of the cutters
///   throws   Error(cancelled)
[[nodiscard]] SplitTriangles splitTriangles(const CutSide& side,
                                            const std::vector<glm::uvec3>& cutters,
                                            const CrossingPoints& crossings,
                                            const std::vector<Seam>& seams,
                                            const Progress* progress);

}  // namespace sherd
