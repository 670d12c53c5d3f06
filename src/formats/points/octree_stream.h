// Points as a compressed octree of the Point Cloud Library: `.binp`.
#pragma once

#include <cstddef>
#include <string>

#include "points/blocks.h"

namespace sherd {

/// A file's bytes, and the number of points that share a voxel with an earlier one.
struct OctreeStream {
  std::string bytes;
  std::size_t merged = 0;
  double voxelSize = 0.0;  ///< of the octree, world units
};

/// Encodes points as the centers of their voxels, in the octree's order. A voxel is 1e-4 wide, as
/// in the paper's data set; its width is multiplied by ten until the longest side has fewer than
/// 2^21 voxels, or divided by ten, down to 1e-6, while it has fewer than 2^10.
///   points  made twice, so that no more than a block of them is held
///   name    for messages
///   throws  Error(input) no points, or not finite
[[nodiscard]] OctreeStream octreeStream(const Blocks<SurfacePoints>& points,
                                        const std::string& name);

}  // namespace sherd
