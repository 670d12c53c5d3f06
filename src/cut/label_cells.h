// Cells of fragments where these have no voxels.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// Returns [voxels] the fragment in whose cell a voxel lies, of those that the labels have: that of
/// the nearest seed, or by the planes and spheres of splits.  Empty where these do not say so:
/// cracks are rough, follow walls, or are given.
///   throws  Error(cancelled)
[[nodiscard]] std::vector<std::uint16_t> cellsOf(const Labels& labels,
                                                 std::span<const openvdb::Coord> voxels,
                                                 const Progress* progress = nullptr);

}  // namespace sherd
