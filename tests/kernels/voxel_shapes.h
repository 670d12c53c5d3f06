// Voxel solids for kernel tests, independent of the code under test: sets of coordinates, and leaf
// blocks made from them.
#pragma once

#include <sherd/solid.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace sherd::voxel_shapes {

struct VoxelSolid {
  std::string name;
  std::set<openvdb::Coord> inside;
  std::set<openvdb::Coord> exteriorBand;  ///< outside voxels within three steps of the inside
};

/// All voxels of the box -extent..extent for which `isInside` holds.
VoxelSolid solidWhere(std::string name, int extent,
                      const std::function<bool(const openvdb::Coord&)>& isInside);

VoxelSolid ball(int radius);
VoxelSolid cup(int radius, int wall);
/// Each voxel of a box is inside with probability `percent`: many components, long winding paths,
/// up to 256 nodes in a leaf.
VoxelSolid sparseRandom(int extent, unsigned percent, unsigned seed);
/// Separate small cubes, some touching only at edges or corners.
VoxelSolid manyComponentsWithin(int extent);
VoxelSolid checkerboard(int extent);

/// Whether SHERD_TEST_SMALL=1: smaller cases, for simulated devices and slow drivers.
bool small();

/// The shapes that every kernel is tested on; small ones if small().
std::vector<VoxelSolid> all();

/// Leaf blocks of a solid.
std::shared_ptr<const LeafBlocks> blocksOf(const VoxelSolid& solid);

/// Index of a voxel in the arrays: leaf * 512 + offset.
std::size_t voxelIndexOf(const LeafBlocks& blocks, const openvdb::Coord& voxel);

/// Whether `a` precedes `b` in the arrays.
bool leafOrder(const openvdb::Coord& a, const openvdb::Coord& b);

/// The six face neighbors.
std::vector<openvdb::Coord> neighbors(const openvdb::Coord& voxel);

}  // namespace sherd::voxel_shapes
