// Metrics and steps in the layout that kernels take.
#pragma once

#include <sherd/labels.h>
#include <sherd/seeds.h>

#include <cstdint>
#include <vector>

#include "cl/int4.h"
#include "voxel_metric.h"

namespace sherd {

/// The metric after stretching by the anisotropy.
///   throws  Error(usage) a zero direction, or a strength outside -0.75..9
[[nodiscard]] sherd_metric metricFor(Metric metric, const Anisotropy& anisotropy);

/// Returns a point or difference, transformed by the metric's matrix.
[[nodiscard]] glm::i64vec3 stretched(const sherd_metric& metric, const glm::i64vec3& steps);

/// Returns a seed's weight in the unit of the metric's squared distances; 0 of other metrics.
[[nodiscard]] inline std::int64_t weightIn(const sherd_metric& metric, std::int64_t weight) {
  return metric.kind == SHERD_EUCLIDEAN ? weight * (std::int64_t{1} << metric.shift) : 0;
}

/// Steps to neighbors for kernels/levels.cl.
struct Steps {
  std::vector<Int4> step;            ///< x, y, z, and the weight in w; the 26 neighbors first
  std::vector<std::int32_t> within;  ///< [steps*2] voxels that a long step crosses, packed
  std::uint32_t leastWeight = 1;
};

/// The steps to 6 or 26 neighbors; weights are 1, or lengths (8 a voxel) with anisotropy.
[[nodiscard]] Steps layerSteps(int neighborhood, const Anisotropy& anisotropy);

/// The 98 steps of a 5^3 chamfer, weighted by their length (16 a voxel) under the anisotropy.
///   source  Borgefors, On Digital Distance Transforms in Three Dimensions, 1996
[[nodiscard]] Steps chamferSteps(const Anisotropy& anisotropy);

}  // namespace sherd
