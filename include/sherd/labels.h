// Growth: which fragment owns each voxel.
#pragma once

#include <sherd/device.h>
#include <sherd/leaf_blocks.h>
#include <sherd/progress.h>
#include <sherd/seeds.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// Fragment ids over the leaf blocks.
struct Labels {
  std::vector<std::uint16_t>
      fragment;  ///< [leaf*512] 1..n on inside voxels, and carried over the outer band; else 0
  std::vector<std::uint32_t>
      cost;  ///< [leaf*512] steps from the seed, inside voxels only; empty unless asked for
};

struct GrowOptions {
  bool keepCost = false;  ///< also return the arrival cost
  int outerSteps = 6;     ///< how many steps labels are carried over the outer band, 0..64
  int stepsPerReadback =
      0;                  ///< kernel launches between two looks at the device's counter; 0: chosen
  int workGroupSize = 0;  ///< work-items per work-group; 0: chosen for the device
};

/// Flood from all seeds at once over faces: an inside voxel belongs to the seed that reaches it in
/// the fewest steps, ties to the lower id.  The answer is one whatever the device, the work-group
/// size or the batch.
///   seedSets  one fracture each, grown together over the same leaf blocks; every seed on an inside
///   voxel return    one Labels per seed set; inside voxels that no seed reaches stay 0 throws
///   Error(device), Error(cancelled), Error(usage) a seed outside the solid
[[nodiscard]] std::vector<Labels> grow(const LeafBlocks& blocks,
                                       std::span<const std::vector<Seed>> seedSets, Device& device,
                                       const GrowOptions& options = {},
                                       const Progress* progress = nullptr);

/// Inside voxels of each fragment: [n+1], [0] counts inside voxels without a label.
[[nodiscard]] std::vector<std::uint64_t> countVoxels(const LeafBlocks& blocks, const Labels& labels,
                                                     int fragments);

}  // namespace sherd
