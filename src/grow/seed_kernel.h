// Labels by a kernel that gives each voxel one of the seeds, such as kernels/nearest.cl.
#pragma once

#include "grow/levels.h"

namespace sherd {

/// Label every inside voxel by a kernel with the arguments of `nearest`.  The cost is computed only
/// with `keepCost`.
[[nodiscard]] Grown growByKernel(GrowthState& state, const SeedTable& seeds, const char* kernel,
                                 const sherd_metric& metric, bool keepCost);

}  // namespace sherd
