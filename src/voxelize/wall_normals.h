// Directions across the walls of a solid.
#pragma once

#include <sherd/solid.h>

#include <glm/mat3x3.hpp>
#include <vector>

namespace sherd {

/// Returns for each leaf the sum of n n^T over its inside voxels within one voxel of the surface,
/// where n is the unit normal of the surface there; its trace is their number.
[[nodiscard]] std::vector<glm::dmat3> wallNormals(const Solid& solid);

}  // namespace sherd
