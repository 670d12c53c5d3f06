// Distance grids: OpenVDB's part of voxelizing.
#pragma once

#include <sherd/grid_fwd.h>
#include <sherd/leaf_blocks.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <functional>
#include <span>

#include "voxelize/fill.h"

namespace sherd {

using FloatGridPtr = std::shared_ptr<openvdb::FloatGrid>;

/// The narrow-band level set of what a mesh fills.
///   return   world units; transform and background by `frame`
///   throws   Error(cancelled)
[[nodiscard]] FloatGridPtr levelSetOf(const Filling& filling, const GridFrame& frame,
                                      const Progress* progress);

/// Make voxels of the outer band inside, as shallow as any may be.
///   grid, blocks  of one solid; both are brought up to date
void addVoxels(openvdb::FloatGrid& grid, LeafBlocks& blocks, std::span<const std::size_t> places);

/// The union of two level sets of one frame; `other` is used up.
void unite(openvdb::FloatGrid& grid, openvdb::FloatGrid& other);

/// Where a grid's voxels lie.
[[nodiscard]] GridFrame frameOf(const openvdb::FloatGrid& grid);

/// The shortest side of a grid's voxels, world units.
[[nodiscard]] double smallestVoxel(const openvdb::FloatGrid& grid);

/// Whether a level set can be a solid's as it is: neither turned, sheared nor mirrored, one voxel
/// size, values to three voxels from the surface.
[[nodiscard]] bool isSolidLevelSet(const openvdb::FloatGrid& grid);

/// How many voxels a grid's solid has, those of tiles included, and about its surface.
struct VoxelCounts {
  double inside = 0.0, surface = 0.0;
};

/// These, where the solid is where values are below the isovalue, or above it.
[[nodiscard]] VoxelCounts voxelsOf(const openvdb::FloatGrid& grid, double isovalue, bool above);

/// The solid of such a level set, on its voxels; what is farther than three voxels from the surface
/// is left out.
[[nodiscard]] Solid solidOf(const openvdb::FloatGrid& levelSet);

/// The inside and outer-band voxels of a level set, interior tiles included.
[[nodiscard]] LeafBlocks leafBlocks(const openvdb::FloatGrid& grid);

/// Set a solid's `voxels` and `box` from its blocks.
void measureVoxels(Solid& solid);

/// A copy of a level set in which the inside voxels that `isSpeck(place)` names are outside.
[[nodiscard]] ConstFloatGridPtr withoutVoxels(const openvdb::FloatGrid& grid,
                                              const LeafBlocks& blocks,
                                              const std::function<bool(std::size_t)>& isSpeck);

}  // namespace sherd
