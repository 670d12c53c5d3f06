// Voxel solids for kernel tests, made without the code under test: sets of coordinates, and leaf
// blocks from them.
#pragma once

#include <sherd/leaf_blocks.h>

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace sherd::voxel_shapes {

struct VoxelSolid {
  std::string name;
  std::set<openvdb::Coord> inside;
  std::set<openvdb::Coord> outer;  ///< outer band: voxels outside within three steps of the inside
};

/// All voxels of the box -extent..extent for which `isInside` holds.
VoxelSolid solidWhere(std::string name, int extent,
                      const std::function<bool(const openvdb::Coord&)>& isInside);

VoxelSolid ball(int radius);
VoxelSolid cup(int radius, int wall);
/// Each voxel of a box inside with probability `percent`: many parts, long winding ways, up to 256
/// nodes in a leaf.
VoxelSolid sparseRandom(int extent, unsigned percent, unsigned seed);
/// Separate small cubes, some touching only at edges or corners.
VoxelSolid manyPartsWithin(int extent);
VoxelSolid checkerboard(int extent);

/// SHERD_TEST_SMALL=1: less to do, for devices that are simulated.
bool small();

/// The shapes that every kernel is tried on; small ones when small().
std::vector<VoxelSolid> all();

/// Leaf blocks of a solid, with leaves that lie far from the origin on both sides.
LeafBlocks blocksOf(const VoxelSolid& solid);

/// Where a voxel lies in the arrays: leaf * 512 + offset.
std::size_t placeOf(const LeafBlocks& blocks, const openvdb::Coord& voxel);

/// Does `a` come before `b` in the arrays?
bool leafOrder(const openvdb::Coord& a, const openvdb::Coord& b);

/// The six face neighbours.
std::vector<openvdb::Coord> neighbours(const openvdb::Coord& voxel);

}  // namespace sherd::voxel_shapes
