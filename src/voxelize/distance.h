// Distance grids: the part of voxelization that uses OpenVDB.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <functional>
#include <span>

#include "voxelize/fill/fill.h"

namespace sherd {

using FloatGridPtr = std::shared_ptr<openvdb::FloatGrid>;

/// Returns the narrow-band level set of a filling.
///   return   world units; transform and background by `frame`
///   throws   Error(cancelled)
[[nodiscard]] FloatGridPtr levelSetOf(const Filling& filling, const GridFrame& frame,
                                      const Progress* progress);

/// Returns a function that reads values of a grid, fastest of voxels near the one before.  Use it
/// from one thread.
[[nodiscard]] std::function<float(const openvdb::Coord&)> valuesOf(ConstFloatGridPtr grid);

/// Returns a function that interpolates a grid's values at points of its index space.  Use it from
/// any thread.
[[nodiscard]] std::function<float(const glm::dvec3&)> samplesOf(ConstFloatGridPtr grid);

/// Returns a grid that has this value everywhere.  A file that makes one by FloatGrid::create
/// compiles the whole class, in eight seconds.
[[nodiscard]] FloatGridPtr uniformGrid(float value);

/// Multiplies all values of a grid, tiles and background included.
void multiplyValues(openvdb::FloatGrid& grid, double factor);

/// Makes exterior band voxels inside voxels, at the least depth that an inside voxel may have.
///   grid, blocks  of one solid; both are updated
///   voxelIndices  of exterior band voxels
void addVoxels(openvdb::FloatGrid& grid, LeafBlocks& blocks,
               std::span<const std::size_t> voxelIndices);

/// Replaces `grid` by the union of two level sets of one frame; `other` is consumed.
void unite(openvdb::FloatGrid& grid, openvdb::FloatGrid& other);

/// Sizes of voxels, world units: distances of a thousandth of a voxel, and of three, are normal
/// numbers in single precision.
inline constexpr double kSmallestVoxel = 1e-34, kLargestVoxel = 1e37;

/// Longest sides of a mesh that can be voxelized, world units.
inline constexpr double kShortestMesh = 1e-30, kLongestMesh = 1e37;

/// Gives a grid the transform of a frame, of any voxel size.  OpenVDB refuses to copy the transform
/// where voxels are under 1.44e-5 units, as its own copies of a grid do: use those below.
void setFrame(openvdb::FloatGrid& grid, const GridFrame& frame);

/// Returns a grid with the transform, metadata and background of another, without its values.
[[nodiscard]] FloatGridPtr emptyLike(const openvdb::FloatGrid& grid);

/// Returns a copy of a grid, which shares the transform.
[[nodiscard]] FloatGridPtr copyOf(const openvdb::FloatGrid& grid);

/// Returns the frame of a grid.
[[nodiscard]] GridFrame frameOf(const openvdb::FloatGrid& grid);

/// Returns the shortest side of a grid's voxels, world units.
[[nodiscard]] double smallestVoxel(const openvdb::FloatGrid& grid);

/// Whether a level set can be used for a solid unchanged: no rotation, shear or mirroring, one
/// voxel size, and a half width of at least three voxels.
[[nodiscard]] bool isSolidLevelSet(const openvdb::FloatGrid& grid);

/// Whether all values of a grid are finite: those of voxels, tiles and the background.
[[nodiscard]] bool hasFiniteValues(const openvdb::FloatGrid& grid);

/// The number of voxels in a grid's solid, tiles included, and an estimate of those at its surface.
struct VoxelCounts {
  double inside = 0.0, surface = 0.0;
};

/// Returns the counts of the solid whose values are below the isovalue, or above it if `above`.
[[nodiscard]] VoxelCounts voxelsOf(const openvdb::FloatGrid& grid, double isovalue, bool above);

/// Returns the solid of such a level set on the same voxels, trimmed to three voxels from the
/// surface.
///   levelSet  isSolidLevelSet()
[[nodiscard]] Solid solidOf(const openvdb::FloatGrid& levelSet);

/// Returns the inside and exterior band voxels of a level set, interior tiles included.
[[nodiscard]] LeafBlocks leafBlocks(const openvdb::FloatGrid& grid);

/// Sets a solid's `voxels` and `box` from its blocks.
void measureVoxels(Solid& solid);

/// Returns a copy of a level set in which the inside voxels with `isSmallComponent(voxelIndex)` are
/// outside.
[[nodiscard]] ConstFloatGridPtr withoutVoxels(
    const openvdb::FloatGrid& grid, const LeafBlocks& blocks,
    const std::function<bool(std::size_t)>& isSmallComponent);

}  // namespace sherd
