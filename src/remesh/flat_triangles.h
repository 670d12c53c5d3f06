// Triangles without area.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// Flips the longest edges of triangles without area, on which their third corner lies: it splits
/// the triangle beyond the edge.  The surface stays the same set of points.
///   mesh    vertices at one position are one vertex
///   flat    triangles whose corners are on a line
///   return  the mesh, with `source`, the triangle that each is a part of; without triangles where
///           edges beside flat ones are not used once in each direction
[[nodiscard]] TriangleMesh withoutFlat(const TriangleMesh& mesh, std::vector<std::uint32_t> flat);

}  // namespace sherd
