// Intersection of a ray with voxels.
#pragma once

#include <optional>

#include "seed/draw/voxel_index.h"

namespace sherd {

/// Returns the first voxel of an index that a ray hits, if any.  Voxel v is the cube of side 1
/// centered at v; a ray that starts in a voxel hits it.
///   box        contains all voxels of the index
///   origin     index space, finite
///   direction  finite, not 0
///   source     Amanatides and Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987
[[nodiscard]] std::optional<openvdb::Coord> firstVoxelOnRay(const VoxelIndex& voxels,
                                                            const VoxelBox& box,
                                                            const glm::dvec3& origin,
                                                            const glm::dvec3& direction);

}  // namespace sherd
