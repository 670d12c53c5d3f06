// Points of seeds whose voxels are theirs.
#pragma once

#include <sherd/labels.h>

#include <span>
#include <vector>

#include "voxel_metric.h"

namespace sherd {

/// Returns seeds of which each voxel's center is nearest to a seed of the same fragment: where a
/// point beside it is nearer, as happens in neighboring voxels, the seed moves to the center of its
/// voxel.
[[nodiscard]] std::vector<Seed> settled(std::span<const Seed> seeds, const sherd_metric& metric);

/// Returns a point or difference, transformed by the metric's matrix.
[[nodiscard]] glm::i64vec3 stretched(const sherd_metric& metric, const glm::i64vec3& steps);

}  // namespace sherd
