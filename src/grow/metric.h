// Metrics as kernels take them.
#pragma once

#include <sherd/labels.h>
#include <sherd/metric.h>

#include "cl/open_cl.h"
#include "voxel_metric.h"

namespace sherd {

/// A metric whose differences are stretched by the grain first.
///   throws  Error(usage) a grain without direction, or a strength outside -0.75..9
[[nodiscard]] sherd_metric metricFor(Metric metric, const Grain& grain);

/// A step to a neighbour for kernels/levels.cl.
struct Steps {
  std::vector<cl_int4> step;   ///< x, y, z, and the weight in w; steps to the 26 neighbours first
  std::vector<cl_int> within;  ///< [steps*2] the voxels a long step passes over, packed
  cl_uint leastWeight = 1;
};

/// Layers over 6 or 26 neighbours: all weights 1, or by the grain.
[[nodiscard]] Steps layerSteps(int neighborhood, const Grain& grain);

/// The 98 steps of a 5^3 chamfer, weighted by their length (16 a voxel) under the grain.
///   source  Borgefors, On Digital Distance Transforms in Three Dimensions, 1996
[[nodiscard]] Steps chamferSteps(const Grain& grain);

}  // namespace sherd
