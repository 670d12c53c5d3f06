// Seeds well apart.
#pragma once

#include <cstdint>

#include "seed/samplers.h"

namespace sherd {

/// Throw darts at the candidates until `end` voxels are chosen or they need not even differ by more
/// than a voxel.  A dart sticks when it keeps the distance from all that is chosen; after many
/// misses in a row the distance shrinks.  So the distance need not be known for the solid's shape,
/// and the first n of a longer sequence are well apart too.
///   dart    number of the next dart, in and out
///   source  McCool and Fiume, Hierarchical Poisson Disk Sampling Distributions, 1992
void drawApart(const VoxelIndex& candidates, const VoxelBox& box, std::uint64_t seed,
               std::size_t end, std::uint64_t& dart, Chosen& chosen);

}  // namespace sherd
