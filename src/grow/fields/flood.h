// Growth by layers of neighbors.  Method: kernels/flood.cl.
#pragma once

#include "grow/fields/growth_state.h"

namespace sherd {

/// The buffers of one growth on the device, and the launches of its kernels.
class Flood {
 public:
  /// Create a growth without labels, over 6 or 26 neighbors.
  Flood(GrowthState& state, bool keepCost, int neighbors = 6);

  /// Start from seeds.
  void seed(const SeedTable& table);

  /// Start from existing labels: their buffers become this growth's, and voxels that are not in
  /// `kept` [items*8] become 0.
  void load(const DeviceLabels& labels, const DeviceBuffer& kept);

  /// Grow up to `steps` layers into `domain` [leafCount*8], from all owned voxels after the first
  /// call.  Every `perReadback` layers it reads back whether leaves remain on the list.
  void grow(const DeviceBuffer& domain, std::uint32_t steps, std::uint32_t perReadback,
            const Progress* progress);

  /// The labels per voxel, 0 for unreached voxels.
  DeviceLabels labels();
  /// Reads the labels of `count` items from `first` on to the host.  Unlike labels(), it does not
  /// touch device memory for the labels of leaves with at most two.
  [[nodiscard]] std::vector<std::uint16_t> read(std::uint32_t first, std::uint32_t count);
  const DeviceBuffer& cost() const { return cost_; }  ///< [items*512] with keepCost

 private:
  // Launches a kernel that takes FLOOD_STATE and these arguments.
  template <class... Arguments>
  void launch(const char* name, std::size_t work, const Arguments&... arguments);

  GrowthState& state_;
  std::uint32_t keepCost_, neighbors_;
  std::uint32_t step_ = 0;
  bool seeded_ = false;  // the front is the seeds: no restart needed
  DeviceBuffer neighbors27_, domain_, beyond_, owned_, tag_, second_, owner_, fronts_, queued_,
      list_, listCount_, cost_;
};

}  // namespace sherd
