// Corners of a mesh that have one normal.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// Edges of triangles at a larger angle are creases: 30 degrees, as in Blender's automatic
/// smoothing.
inline constexpr double kCreaseCosine = 0.866;

/// Returns [3 * triangles] a number for each corner, equal for the corners at a vertex whose
/// triangles are connected over edges that are no creases and have one neighbor on both sides.
[[nodiscard]] std::vector<std::uint32_t> creaseGroups(const TriangleMesh& mesh);

}  // namespace sherd
