// Steps between voxels of leaf blocks.
#include "voxelize/leaves/leaf_masks.h"

#include <tbb/parallel_for.h>

#include <utility>

namespace sherd {

VoxelMask grownBySteps(const LeafBlocks& blocks, VoxelMask mask, const VoxelMask& within,
                       int steps) {
  VoxelMask next(mask.size());
  for (int step = 0; step < steps; ++step) {
    tbb::parallel_for(std::size_t{0}, blocks.count(), [&](std::size_t leaf) {
      for (std::size_t x = 0; x < 8; ++x) {
        std::uint64_t reached = withBeside(&mask[leaf * 8], x);
        for (std::size_t side = 0; side < 6; ++side) {
          const std::uint32_t neighbor = blocks.neighbors[leaf * 6 + side];
          if (neighbor != LeafBlocks::kNone) reached |= besideFace(mask, neighbor, side, x);
        }
        next[leaf * 8 + x] = mask[leaf * 8 + x] | (reached & within[leaf * 8 + x]);
      }
    });
    std::swap(mask, next);
  }
  return mask;
}

}  // namespace sherd
