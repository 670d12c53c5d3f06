// The ways of voxels to the middle of their walls, for kernels.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "grow/growth_state.h"
#include "voxelize/wall_middles.h"

namespace sherd {

struct WaysOnDevice {
  DeviceBuffer way;        ///< [leaves*512*3], or [1] where no fracture uses it
  std::int32_t reach = 0;  ///< the longest along an axis
  DeviceBuffer isUsed;     ///< [fractures] uint
};

/// Uploads the ways.
///   walls  [fractures] the same, or null where a fracture uses none
inline WaysOnDevice uploadWays(GrowthState& state,
                               std::span<const std::shared_ptr<const WallMiddles>> walls) {
  const WallMiddles* used = nullptr;
  std::vector<std::uint32_t> isUsed;
  for (const std::shared_ptr<const WallMiddles>& own : walls) {
    isUsed.push_back(own != nullptr ? 1 : 0);
    if (own) used = own.get();
  }
  const std::array<std::int16_t, 1> none{0};
  std::span<const std::int16_t> ways = used != nullptr ? used->ways() : none;
  std::vector<std::int16_t> ofLayers;
  if (used != nullptr && state.apart != nullptr) {
    ofLayers = state.apart->gathered(ways, std::size_t{SHERD_LEAF_SIZE} * 3);
    ways = ofLayers;
  }
  return {uploadBuffer<std::int16_t>(state.device, ways), used != nullptr ? used->reach() : 0,
          uploadBuffer<std::uint32_t>(state.device, isUsed)};
}

}  // namespace sherd
