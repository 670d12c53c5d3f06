// Distance grids: OpenVDB's part of voxelizing.
#pragma once

#include <sherd/grid_fwd.h>
#include <sherd/leaf_blocks.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <functional>

#include "voxelize/fill.h"

namespace sherd {

using FloatGridPtr = std::shared_ptr<openvdb::FloatGrid>;

/// The narrow-band level set of what a mesh fills.
///   return   world units; transform and background by `frame`
///   throws   Error(cancelled)
[[nodiscard]] FloatGridPtr levelSetOf(const Filling& filling, const GridFrame& frame,
                                      const Progress* progress);

/// The union of two level sets of one frame; `other` is used up.
void unite(openvdb::FloatGrid& grid, openvdb::FloatGrid& other);

/// Where a grid's voxels lie.
[[nodiscard]] GridFrame frameOf(const openvdb::FloatGrid& grid);

/// The inside and outer-band voxels of a level set, interior tiles included.
[[nodiscard]] LeafBlocks leafBlocks(const openvdb::FloatGrid& grid);

/// A copy of a level set in which the inside voxels that `isSpeck(place)` names are outside.
[[nodiscard]] ConstFloatGridPtr withoutVoxels(const openvdb::FloatGrid& grid,
                                              const LeafBlocks& blocks,
                                              const std::function<bool(std::size_t)>& isSpeck);

}  // namespace sherd
