// Control of fragment sizes: a least share, and balancing.
#pragma once

#include <sherd/labels.h>

#include <vector>

#include "grow/fields/seeded_labels.h"
#include "grow/sized/least_share.h"

namespace sherd {

/// Grows fragments, repeatedly until no fragment is below minShare.  A fragment below it loses its
/// seeds, so that its neighbors fill its volume, and its id gets a new seed in the largest
/// fragment; from the eighth growth on every seed also takes a Lloyd step.
///   seeds   as returned by placeSeeds
/// With ShareOptions::sizes grows as grownToSizes does.
///   throws  Error(usage) the sizes are drawn and the growth gives no Voronoi cells; minShare
///   cannot be reached: above 1 / fragments, a component of the solid
///           below it, or not within `tries`; what grow throws
///   source  Lloyd, Least squares quantization in PCM, 1982 (the steps on centers)
[[nodiscard]] SeededLabels growWithShares(const Solid& solid, const VoxelComponents& components,
                                          std::vector<Seed> seeds, Device& device,
                                          const SharedGrowthOptions& options,
                                          const Progress* progress = nullptr);

}  // namespace sherd
