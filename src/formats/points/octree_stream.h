// Points as a compressed octree of the Point Cloud Library: `.binp`.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// The file's bytes, and how many points share a voxel with one before them.
struct OctreeStream {
  std::string bytes;
  std::size_t merged = 0;
  double voxelSize = 0.0;  ///< of the octree, world units
};

/// Points become the centres of their voxels, in the octree's order.  A voxel is 1e-4 wide, as in
/// the paper's data set; ten times as much, again and again, until 2^21 reach round the points; or
/// a tenth, down to 1e-6, while less than 2^10 do.
///   name    for messages
///   throws  Error(input) no points, or not finite
[[nodiscard]] OctreeStream octreeStream(std::span<const glm::dvec3> points,
                                        const std::string& name);

}  // namespace sherd
