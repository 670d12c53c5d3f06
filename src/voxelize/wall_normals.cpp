// Normals are gradients of the level set, by central differences.
#include "voxelize/wall_normals.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <bit>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "voxelize/distance.h"

namespace sherd {

std::vector<glm::dmat3> wallNormals(const Solid& solid) {
  const LeafBlocks& blocks = *solid.blocks;
  std::vector<glm::dmat3> sums(blocks.count(), glm::dmat3(0.0));
  const auto reach = static_cast<float>(-solid.frame.voxelSize);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sums.size(), 64), [&](const auto& range) {
    const auto valueAt = valuesOf(solid.distance);
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      for (std::size_t x = 0; x < 8; ++x) {
        for (std::uint64_t bits = blocks.inside[leaf * 8 + x]; bits; bits &= bits - 1) {
          const openvdb::Coord at = blocks.voxelAt(
              leaf * 512 + x * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
          if (valueAt(at) < reach) continue;
          glm::dvec3 gradient(0.0);
          for (int axis = 0; axis < 3; ++axis) {
            openvdb::Coord low = at, high = at;
            --low[axis];
            ++high[axis];
            gradient[axis] = static_cast<double>(valueAt(high)) - static_cast<double>(valueAt(low));
          }
          const double length = glm::length(gradient);
          if (length == 0.0) continue;
          sums[leaf] += glm::outerProduct(gradient / length, gradient / length);
        }
      }
    }
  });
  return sums;
}

}  // namespace sherd
