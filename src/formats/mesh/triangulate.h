// Polygons to triangles.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Append polygon.size() - 2 triangles, as places in the polygon (0 is its first corner), that fill
/// it and keep its sense of turning.  A convex
/// polygon becomes a fan about its first corner, any other simple one is cut by ears; a polygon
/// that crosses itself still gives a surface bounded by its edges.
///   vertices   all vertices of the mesh
///   polygon    [>= 3] indices of its corners
void triangulate(std::span<const glm::dvec3> vertices, std::span<const std::uint32_t> polygon,
                 std::vector<glm::uvec3>& places);

}  // namespace sherd
