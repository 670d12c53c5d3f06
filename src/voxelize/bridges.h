// Voxels that keep thin walls in one piece.
#pragma once

#include <sherd/leaf_blocks.h>

#include <cstddef>
#include <vector>

#include "voxelize/fill.h"

namespace sherd {

/// A wall thinner than a voxel's diagonal may have voxels that touch by an edge or a corner only,
/// and so falls into parts that the mesh does not have.  Where two such voxels' centres see each
/// other through the solid, and no way leads from one to the other close by, these are the voxels
/// that join them: of those between the two the nearest to the surface.  Walls of kHeldWallVoxels
/// then hold together whatever way they run.
///   blocks  of the solid without bridges
///   return  places of voxels that are outside, ascending
///   throws  Error(cancelled)
[[nodiscard]] std::vector<std::size_t> bridgesOf(const LeafBlocks& blocks, const Filling& filling,
                                                 const Progress* progress = nullptr);

}  // namespace sherd
