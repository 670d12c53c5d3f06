// Where a ray meets the solid.
#pragma once

#include <optional>

#include "seed/voxel_index.h"

namespace sherd {

/// The first voxel of an index that a half line meets, if any.  Voxel v is the cube of side 1 about
/// v; a half line that starts in a voxel meets it there.
///   box        holds all voxels of the index
///   origin     index space, finite
///   direction  finite, not 0
///   source     Amanatides and Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987
[[nodiscard]] std::optional<openvdb::Coord> firstVoxelOnRay(const VoxelIndex& voxels,
                                                            const VoxelBox& box,
                                                            const glm::dvec3& origin,
                                                            const glm::dvec3& direction);

}  // namespace sherd
