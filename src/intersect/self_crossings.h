// Triangles of one mesh that cross each other.
#pragma once

#include <sherd/progress.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Which pairs of triangles are tested.
struct CrossingPairs {
  std::span<const std::uint8_t> of{};       ///< [triangles] 0 or 1: with one that has 1; empty: all
  std::span<const std::uint32_t> source{};  ///< [triangles] not those of one source; empty: all
};

/// Returns the pairs of triangles that have a point in common other than common vertices and edges,
/// decided exactly.  Triangles that share an edge cross if they are folded onto each other.
///   triangles  indices of vertices; triangles that share an index are connected there
///   return     lower index first, ascending
///   throws     Error(cancelled)
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> selfCrossings(
    std::span<const glm::dvec3> vertices, std::span<const glm::uvec3> triangles,
    const Progress* progress = nullptr, const CrossingPairs& tested = {});

/// Returns whether two different triangles of one mesh are such a pair.
[[nodiscard]] bool trianglesCross(std::span<const glm::dvec3> vertices, const glm::uvec3& a,
                                  const glm::uvec3& b);

}  // namespace sherd
