// Poisson-disk sampling of seeds.
#pragma once

#include <cstdint>
#include <functional>

#include "seed/draw/candidates.h"

namespace sherd {

/// Throws darts at the box until `end` candidates are chosen, or the minimum distance is a 4096th
/// of its longest side.  A dart that meets the solid is accepted if it keeps the minimum distance
/// from all that are chosen; after many misses in a row the distance shrinks.  So it adapts to the
/// solid's shape, and the first n of a longer sequence are well separated too.
///   dart      index of the next dart, in and out
///   drawAnew  adds a candidate in place of a dart that has no free voxel
///   throws    Error(cancelled)
///   source    McCool and Fiume, Hierarchical Poisson Disk Sampling Distributions, 1992
void drawApart(const Candidates& candidates, std::uint64_t seed, std::size_t end,
               std::uint64_t& dart, Chosen& chosen, const std::function<void()>& drawAnew,
               const Progress* progress);

}  // namespace sherd
