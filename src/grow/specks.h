// Parts too small to be fragments.
#pragma once

#include <sherd/seeds.h>
#include <sherd/solid.h>

namespace sherd {

/// The solid without its parts of fewer than kSpeckVoxels voxels; they are counted in `specks`.
///   parts   of this solid; brought up to date
///   throws  Error(input) every part is a speck
[[nodiscard]] Solid dropSpecks(Solid solid, Parts& parts, Device& device);

}  // namespace sherd
