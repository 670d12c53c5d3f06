// Triangulates polygons.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Appends polygon.size() - 2 triangles that fill the polygon and keep its orientation, as indices
/// of its corners (0 is the first). A convex polygon becomes a fan about its first corner, any
/// other simple one is cut by ears; a self-intersecting polygon still gives a surface bounded by
/// its edges.
///   vertices   all vertices of the mesh
///   polygon    [>= 3] indices of its corners
void triangulate(std::span<const glm::dvec3> vertices, std::span<const std::uint32_t> polygon,
                 std::vector<glm::uvec3>& triangles);

}  // namespace sherd
