// Growth by layers of neighbours; the method is described in kernels/flood.cl.
#pragma once

#include "grow/growth_state.h"

namespace sherd {

/// One growth on the device: its buffers, and the kernels launched over them.
class Flood {
 public:
  /// A growth that has nothing yet, over faces or all 26 neighbours.
  Flood(GrowthState& state, bool keepCost, int neighbours = 6);

  /// Begin with seeds.
  void seed(const SeedTable& table);

  /// Begin with labels that exist: `labels` [items*512] becomes this growth's own, and what is not
  /// in `kept` [items*8] is 0.
  void load(const DeviceBuffer& labels, const DeviceBuffer& kept);

  /// Take up to `steps` layers into `domain` [leafCount*8], from all that is owned when this is not
  /// the first growth, looking every `perReadback` layers whether anything is left to do.
  void grow(const DeviceBuffer& domain, std::uint32_t steps, std::uint32_t perReadback,
            const Progress* progress);

  /// The labels [items*512], 0 where nothing reached.
  DeviceBuffer labels();
  /// The same of `count` items from `first` on, on the host: a leaf that saw no third label takes
  /// up no memory of the device's for them.
  [[nodiscard]] std::vector<std::uint16_t> read(cl_uint first, cl_uint count);
  const DeviceBuffer& cost() const { return cost_; }  ///< [items*512] when kept

 private:
  cl_uint setState(cl::Kernel& kernel);
  template <class... Arguments>
  void launch(const char* name, std::size_t work, const Arguments&... arguments);

  GrowthState& state_;
  cl_uint keepCost_, neighbours_;
  cl_uint step_ = 0;
  bool seeded_ = false;  // the seeds are the front: no restart
  DeviceBuffer round_, domain_, beyond_, owned_, tag_, second_, owner_, fronts_, queued_, list_,
      listCount_, cost_;
};

}  // namespace sherd
