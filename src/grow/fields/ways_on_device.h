// The ways of voxels to the middle of their walls, for kernels.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "grow/fields/growth_state.h"
#include "voxelize/wall_middles.h"

namespace sherd {

struct WaysOnDevice {
  DeviceBuffer way;        ///< [leaves*512*3], or [1] where no fracture uses it
  std::int32_t reach = 0;  ///< the longest along an axis
  DeviceBuffer isUsed;     ///< [fractures] uint
};

/// The ways of the leaves that growth runs over.
class WallWays {
 public:
  ///   walls  [fractures] the same, or null where a fracture uses none; kept by reference
  WallWays(const GrowthState& state, std::span<const std::shared_ptr<const WallMiddles>> walls) {
    for (const std::shared_ptr<const WallMiddles>& own : walls) {
      isUsed_.push_back(own != nullptr ? 1 : 0);
      if (own) used_ = own.get();
    }
    if (used_ == nullptr) return;
    ways_ = used_->ways();
    if (state.apart == nullptr) return;
    ofLayers_ = state.apart->gathered(ways_, kOfALeaf);
    ways_ = ofLayers_;
  }
  WallWays(const WallWays&) = delete;
  WallWays& operator=(const WallWays&) = delete;

  /// Uploads those of all leaves and fractures.
  [[nodiscard]] WaysOnDevice uploaded(DeviceImpl& device) const {
    return upload(device, ways_, isUsed_);
  }

  /// Uploads those of some leaves for one fracture.
  [[nodiscard]] WaysOnDevice uploaded(DeviceImpl& device, std::size_t fracture,
                                      std::size_t firstLeaf, std::size_t leaves) const {
    const auto isUsed = std::span(isUsed_).subspan(fracture, 1);
    if (isUsed.front() == 0) return upload(device, {}, isUsed);
    return upload(device, ways_.subspan(firstLeaf * kOfALeaf, leaves * kOfALeaf), isUsed);
  }

 private:
  static constexpr std::size_t kOfALeaf = std::size_t{SHERD_LEAF_SIZE} * 3;

  [[nodiscard]] WaysOnDevice upload(DeviceImpl& device, std::span<const std::int16_t> ways,
                                    std::span<const std::uint32_t> isUsed) const {
    constexpr std::array<std::int16_t, 1> kNone{0};
    if (ways.empty()) ways = kNone;
    return {uploadBuffer<std::int16_t>(device, ways), used_ != nullptr ? used_->reach() : 0,
            uploadBuffer<std::uint32_t>(device, isUsed)};
  }

  const WallMiddles* used_ = nullptr;
  std::vector<std::uint32_t> isUsed_{};   // [fractures]
  std::span<const std::int16_t> ways_{};  // [leaves*512*3], or empty
  std::vector<std::int16_t> ofLayers_{};
};

}  // namespace sherd
