// Points of seeds whose voxels are theirs.
#pragma once

#include <sherd/labels.h>

#include <memory>
#include <span>
#include <vector>

#include "voxelize/wall_middles.h"

namespace sherd {

/// Returns seeds of which each voxel's center is nearest to a seed of the same fragment: where a
/// point beside it is nearer, as happens in neighboring voxels, the seed moves to the center of its
/// voxel.  Where that does not suffice because of their weights, the weight of the other is lowered
/// until it does.
///   walls  null, or those at whose middle voxels are compared, by Euclidean distances: it takes
///   the
///          place of the center then, and points that move may leave their voxels.  Becomes null
///          where voxels of two fragments' seeds have the same middle: see withDistinctMiddles
[[nodiscard]] std::vector<Seed> settled(std::span<const Seed> seeds, Metric metric,
                                        const Anisotropy& anisotropy,
                                        std::shared_ptr<const WallMiddles>& walls);

}  // namespace sherd
