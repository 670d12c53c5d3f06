// Seeds with middles of their own in thin walls.
#pragma once

#include <sherd/seeds.h>

#include <vector>

#include "voxelize/wall_middles.h"

namespace sherd {

/// Returns seeds of which no two of different fragments have voxels with the same middle of the
/// wall, which growth cannot distinguish: voxels on both sides of a middle that lies between them.
/// The later seed moves to the center of a voxel near it that is connected over faces; it stays if
/// there is none within a few voxels.
///   blocks  of the solid
///   walls   of blocks with the same leaves
[[nodiscard]] std::vector<Seed> withDistinctMiddles(std::vector<Seed> seeds,
                                                    const LeafBlocks& blocks,
                                                    const WallMiddles& walls);

}  // namespace sherd
