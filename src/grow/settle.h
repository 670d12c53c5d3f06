// Points of seeds whose voxels are theirs.
#pragma once

#include <sherd/labels.h>

#include <span>
#include <vector>

namespace sherd {

/// Returns seeds of which each voxel's center is nearest to a seed of the same fragment: where a
/// point beside it is nearer, as happens in neighboring voxels, the seed moves to the center of its
/// voxel.  Where that does not suffice because of their weights, the weight of the other is lowered
/// until it does.
[[nodiscard]] std::vector<Seed> settled(std::span<const Seed> seeds, Metric metric,
                                        const Anisotropy& anisotropy);

}  // namespace sherd
