// Parts too small to be fragments, and the solid's own counts.
#pragma once

#include <sherd/seeds.h>
#include <sherd/solid.h>

namespace sherd {

/// Set `voxels` and `box` from the blocks.
void measureVoxels(Solid& solid);

/// The solid without its parts of fewer than kSpeckVoxels voxels; they are counted in `specks`.
///   parts   of this solid; brought up to date
///   throws  Error(input) every part is a speck
[[nodiscard]] Solid dropSpecks(Solid solid, Parts& parts, Device& device);

}  // namespace sherd
