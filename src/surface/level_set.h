// A fragment's level set, cut out of the solid's.
#pragma once

#include <sherd/grid_fwd.h>
#include <sherd/solid.h>

#include <cstdint>
#include <memory>
#include <span>

#include "surface/cut.h"

namespace sherd {

/// The solid's level set cut to a fragment: max(solid, distance to the cut).
///   leaves  the leaves that hold the fragment or lie within two voxels of it, ascending
[[nodiscard]] ConstFloatGridPtr fragmentLevelSet(const Solid& solid, const Cut& cut,
                                                 std::uint16_t fragment,
                                                 std::span<const std::uint32_t> leaves);

/// The level set as a fog volume: 0 outside, 1 inside, rising over the three voxels below the
/// surface, or as deep as a thin body is.
[[nodiscard]] std::shared_ptr<openvdb::FloatGrid> fogVolume(const openvdb::FloatGrid& levelSet);

}  // namespace sherd
