// Triangles of one mesh that cross each other.
#pragma once

#include <sherd/progress.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Returns the pairs of triangles that have a point in common other than common vertices and edges,
/// decided exactly.  Triangles that share an edge cross if they are folded onto each other.
///   triangles  indices of vertices; triangles that share an index are connected there
///   return     lower index first, ascending
///   throws     Error(cancelled)
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> selfCrossings(
    std::span<const glm::dvec3> vertices, std::span<const glm::uvec3> triangles,
    const Progress* progress = nullptr);

}  // namespace sherd
