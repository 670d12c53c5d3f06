// Poisson-disk sampling of seeds.
#pragma once

#include <cstdint>

#include "seed/samplers.h"

namespace sherd {

/// Draws darts among the candidates until `end` voxels are chosen or the minimum distance is one
/// voxel.  A dart is accepted if it keeps the minimum distance from all chosen voxels; after many
/// misses in a row the distance shrinks.  So it adapts to the solid's shape, and the first n voxels
/// of a longer sequence are well separated too.
///   dart    index of the next dart, in and out
///   source  McCool and Fiume, Hierarchical Poisson Disk Sampling Distributions, 1992
void drawApart(const VoxelIndex& candidates, const VoxelBox& box, std::uint64_t seed,
               std::size_t end, std::uint64_t& dart, Chosen& chosen);

}  // namespace sherd
