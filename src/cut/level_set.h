// Level sets of fragments.
#pragma once

#include <sherd/solid.h>

#include <cstdint>
#include <memory>
#include <span>

#include "cut/cut.h"

namespace sherd {

/// Returns the level set of a fragment: max(solid, distance to the cut).
///   leaves  the leaves that hold the fragment or lie within two voxels of it, ascending
[[nodiscard]] ConstFloatGridPtr fragmentLevelSet(const Solid& solid, const Cut& cut,
                                                 std::uint16_t fragment,
                                                 std::span<const std::uint32_t> leaves);

/// Returns a level set as a fog volume: 0 outside, 1 inside, with a ramp over the three voxels
/// below the surface, or over the depth of a thinner fragment.
[[nodiscard]] std::shared_ptr<openvdb::FloatGrid> fogVolume(const openvdb::FloatGrid& levelSet);

}  // namespace sherd
