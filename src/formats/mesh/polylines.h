// Joins edges to polylines.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Joins edges at vertices, of which those at the same position are one.  A polyline ends where one
/// edge or more than two meet; a ring begins and ends at its lowest vertex.  Edges without a length
/// are dropped, and of several between the same vertices one is kept.
///   edges   below vertices.size()
///   return  by their first vertices, those of rings last
[[nodiscard]] std::vector<std::vector<glm::dvec3>> joinedPolylines(
    std::span<const glm::dvec3> vertices, std::span<const std::array<std::uint32_t, 2>> edges);

}  // namespace sherd
