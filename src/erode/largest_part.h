// What stays of a fragment that fell apart.
#pragma once

#include "erode/masks.h"

namespace sherd {

/// The largest 6-connected part of a fragment: [n] masks.  Of equal parts that with the lowest
/// voxel by x, y, z.
[[nodiscard]] std::vector<LeafMask> largestPart(const FragmentMasks& fragment);

}  // namespace sherd
