// Triangles of quads that cross each other.
#pragma once

#include <sherd/progress.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// The two triangles of a quad.
struct QuadTriangles {
  std::array<glm::uvec3, 2> triangle{};  ///< of vertices
  std::array<bool, 2> isTested{};        ///< against all others
  std::uint16_t offset = 0;              ///< in the leaf: of the lower end of the quad's edge
};

/// How far beyond its cell a vertex may lie, in voxels.
inline constexpr double kMostOutside = 0.45;

/// Returns the vertices of pairs of triangles that cross as by selfCrossings, at least one of them
/// tested; may repeat.  Quads are small, so that only those of the next cells are compared.
///   origins        of the leaves
///   neighborhoods  likewise
///   quads          [leaves]
///   vertices       index space, no farther than kMostOutside from their cells
///   throws         Error(cancelled)
[[nodiscard]] std::vector<std::uint32_t> verticesOfCrossings(
    std::span<const openvdb::Coord> origins, std::span<const LeafNeighbors> neighborhoods,
    std::span<const std::vector<QuadTriangles>> quads, std::span<const glm::dvec3> vertices,
    const Progress* progress);

}  // namespace sherd
