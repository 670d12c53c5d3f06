// The largest connected part of one fragment.
#pragma once

#include <cstdint>
#include <vector>

#include "erode/masks.h"

namespace sherd {

struct LargestPart {
  std::vector<LeafMask> masks;  ///< [n] as those of the fragment
  std::uint64_t voxels = 0;
};

/// Returns the 6-connected part of a fragment with the most voxels, of equal ones that with the
/// first voxel in leaf order.
[[nodiscard]] LargestPart largestPart(const FragmentMasks& fragment);

/// Returns the number of voxels of masks.
[[nodiscard]] std::uint64_t voxelsOf(const std::vector<LeafMask>& masks);

}  // namespace sherd
