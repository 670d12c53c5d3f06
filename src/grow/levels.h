// Growth in the order of arrival cost; the method is described in kernels/levels.cl.
#pragma once

#include "grow/growth_state.h"
#include "grow/metric.h"

namespace sherd {

/// Labels and their arrival costs, [items*512] each.
struct Grown {
  DeviceBuffer labels;  ///< ushort, 0 where nothing reached
  DeviceBuffer cost;
};

/// Grow from seeds; a step costs its weight.
[[nodiscard]] Grown growByWeight(GrowthState& state, const SeedTable& seeds, const Steps& steps,
                                 const Progress* progress);

/// Grow from seeds over faces; what counts is the largest distance to the seed met on the way.
[[nodiscard]] Grown growChain(GrowthState& state, const SeedTable& seeds,
                              const sherd_metric& metric, const Progress* progress);

/// Grow what is `kept` of `labels` over the rest of the inside, in place.
void regrowByWeight(GrowthState& state, const DeviceBuffer& labels, const DeviceBuffer& kept,
                    const Steps& steps, const Progress* progress);

}  // namespace sherd
