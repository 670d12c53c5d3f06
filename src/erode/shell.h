// The shell of a fragment.
#pragma once

#include "erode/masks.h"

namespace sherd {

/// The voxels of a fragment that have one of their 26 neighbours outside it: [n] masks, the
/// fragment less tools::erodeActiveValues.
///   throws  Error(internal) OpenVDB failed
[[nodiscard]] std::vector<LeafMask> shellOf(const FragmentMasks& fragment);

}  // namespace sherd
