// Small components of fragments that are broken again.
#pragma once

#include <sherd/device.h>
#include <sherd/fracture.h>

#include <optional>
#include <set>

namespace sherd {

/// Returns the leaves of the whole solid with the voxels of one fragment, without an exterior band.
[[nodiscard]] LeafBlocks blocksOf(const FinishedFracture& finished, int id);

/// Drops the components under kSmallComponentVoxels voxels of fragments that are broken again, as
/// of a solid that is broken the first time: an erosion may have left them.  Of a fragment that has
/// only such components the largest stays.  Their voxels leave the solid and the labels, where they
/// are counted, and their bodies leave the fragment's mesh.
///   return  nothing if there are none
[[nodiscard]] std::optional<FinishedFracture> withoutIslands(const FinishedFracture& finished,
                                                             const std::set<int>& broken,
                                                             Device& device);

}  // namespace sherd
