// Voxels that keep thin walls connected.
#pragma once

#include <sherd/solid.h>

#include <cstddef>
#include <vector>

#include "voxelize/fill/fill.h"

namespace sherd {

/// Returns the outside voxels that connect inside voxels which share only an edge or a corner.
///
/// Such voxels occur in walls thinner than a voxel's diagonal and would split a connected mesh into
/// several components.  Two of them are connected if the segment between their centers stays in
/// the solid and no 6-connected path joins them nearby; the path between them takes the voxels
/// nearest to the surface.  Walls of kHeldWallVoxels then stay connected in every orientation.
///   blocks  of the solid without bridges
///   return  voxel indices, ascending
///   throws  Error(cancelled)
[[nodiscard]] std::vector<std::size_t> bridgesOf(const LeafBlocks& blocks, const Filling& filling,
                                                 const Progress* progress = nullptr);

}  // namespace sherd
