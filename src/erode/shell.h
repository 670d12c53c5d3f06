// The outermost layer of a fragment's voxels.
#pragma once

#include "erode/masks.h"

namespace sherd {

/// Returns the voxels of a fragment with at least one of their 26 neighbors outside it: [n] masks,
/// the fragment minus tools::erodeActiveValues.
///   throws  Error(internal) OpenVDB failed
[[nodiscard]] std::vector<LeafMask> shellOf(const FragmentMasks& fragment);

}  // namespace sherd
