// Growth by splits: pieces are split in two by planes, generation after generation.  Kernels:
// kernels/split.cl.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <span>
#include <vector>

#include "grow/fields/growth_state.h"
#include "grow/splits/sequential.h"

namespace sherd {

/// A fracture after all splits.
struct SplitPieces {
  std::vector<Split> splits;   ///< a piece before those that come of it
  std::vector<Seed> seeds;     ///< [fragments] by id: an inner voxel of each
  std::vector<double> shares;  ///< [fragments] by id: those of the run
  GivenSplits decided;         ///< in voxels of the grid
};

struct SplitGrowth {
  DeviceLabels labels;
  std::vector<SplitPieces> fractures;
};

/// Splits the components of a solid until there are as many pieces as shares.  All pieces of a
/// generation are split in one launch, those of all fractures together; then components are found,
/// so that every piece is connected.
///   components  of the solid, as many as shares or fewer
///   runs        [fractures]
///   throws      Error(device); Error(cancelled)
[[nodiscard]] SplitGrowth splitPieces(GrowthState& state, const VoxelComponents& components,
                                      std::span<const SplitRun> runs, const GrowOptions& options,
                                      const Progress* progress);

}  // namespace sherd
