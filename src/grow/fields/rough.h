// Rough cracks.  Method: kernels/rough.cl.
#pragma once

#include <optional>
#include <span>

#include "grow/fields/growth_state.h"
#include "grow/fields/relief.h"

namespace sherd {

/// Give every voxel the label at the end of its displacement; primary seeds keep their label.
///   noiseSeeds  [fractures]
///   anchors     [fractures] voxels that stay where they are; missing ones are none
[[nodiscard]] DeviceBuffer roughened(GrowthState& state, const DeviceLabels& labels,
                                     const SeedTable& seeds,
                                     std::span<const std::uint64_t> noiseSeeds,
                                     std::span<const std::optional<openvdb::Coord>> anchors,
                                     const NoiseOctaves& octaves);

}  // namespace sherd
