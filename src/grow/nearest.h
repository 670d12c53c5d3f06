// Labels by the nearest seed, across gaps too.  Method: kernels/nearest.cl.
#pragma once

#include "grow/levels.h"

namespace sherd {

/// Label every inside voxel by its nearest seed.  The cost is computed only with `keepCost`.
[[nodiscard]] Grown growNearest(GrowthState& state, const SeedTable& seeds,
                                const sherd_metric& metric, bool keepCost);

}  // namespace sherd
