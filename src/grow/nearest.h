// Nearest seeds, blind to what lies between; the method is described in kernels/nearest.cl.
#pragma once

#include "grow/levels.h"

namespace sherd {

/// Label every inside voxel by its nearest seed.  The cost is only made when asked for.
[[nodiscard]] Grown growNearest(GrowthState& state, const SeedTable& seeds,
                                const sherd_metric& metric, bool keepCost);

}  // namespace sherd
