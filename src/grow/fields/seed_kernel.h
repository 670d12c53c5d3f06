// Labels by a kernel that gives each voxel one of the seeds, such as kernels/nearest.cl.
#pragma once

#include <memory>
#include <span>

#include "grow/fields/levels.h"
#include "voxelize/wall_middles.h"

namespace sherd {

/// Label every inside voxel by a kernel with the arguments of `nearest`: with one of the seeds in
/// its layer.  The cost is computed only
/// with `keepCost`.
///   walls  [fractures] see GrowOptions::walls
[[nodiscard]] Grown growByKernel(GrowthState& state, const SeedTable& seeds, const char* kernel,
                                 const sherd_metric& metric,
                                 std::span<const std::shared_ptr<const WallMiddles>> walls,
                                 bool keepCost);

}  // namespace sherd
