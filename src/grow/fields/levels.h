// Growth in the order of arrival cost.  Method: kernels/levels.cl.
#pragma once

#include "grow/fields/growth_state.h"
#include "grow/fields/metric.h"

namespace sherd {

/// Labels and their arrival costs.
struct Grown {
  DeviceLabels labels;  ///< 0 for unreached voxels
  DeviceBuffer cost;    ///< [items*512] uint
};

/// Grow from seeds; a step costs its weight.
[[nodiscard]] Grown growByWeight(GrowthState& state, const SeedTable& seeds, const Steps& steps,
                                 const Progress* progress);

/// Grow from seeds over faces; the cost is the largest distance to the seed on the path.
[[nodiscard]] Grown growChain(GrowthState& state, const SeedTable& seeds,
                              const sherd_metric& metric, const Progress* progress);

/// Regrow the inside voxels outside `kept` from the kept `labels`, in place.  Memory is allocated
/// for the leaves around those voxels only.
void regrowByWeight(GrowthState& state, const DeviceLabels& labels, const DeviceBuffer& kept,
                    const Steps& steps, const Progress* progress);

}  // namespace sherd
