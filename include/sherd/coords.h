// Points typed by their space, and the transform between index space and world space.
#pragma once

#include <sherd/grid_fwd.h>

#include <algorithm>
#include <glm/vec3.hpp>

namespace sherd {

/// A position in one space: mixing spaces does not compile.
template <class Space>
struct Point {
  glm::dvec3 v{0.0};
};
using WorldPoint = Point<struct WorldSpace>;  ///< the mesh's own length unit
using IndexPoint = Point<struct IndexSpace>;  ///< voxels; voxel centers at integers

/// The grid transform: the center of voxel (i,j,k) is origin + voxelSize * (i,j,k).
/// voxelize() puts `origin` at the lower corner of the mesh's box plus half a voxel.
struct GridFrame {
  WorldPoint origin;       ///< world position of voxel (0,0,0)'s center
  double voxelSize = 1.0;  ///< world units per voxel, > 0

  IndexPoint indexFromWorld(WorldPoint p) const { return {(p.v - origin.v) / voxelSize}; }
  WorldPoint worldFromIndex(IndexPoint p) const { return {origin.v + voxelSize * p.v}; }
};

/// Voxels min..max, inclusive.
struct VoxelBox {
  openvdb::Coord min{0, 0, 0};
  openvdb::Coord max{-1, -1, -1};

  bool empty() const { return max.x() < min.x(); }
  openvdb::Coord dims() const { return max - min + openvdb::Coord(1, 1, 1); }
  int longestSide() const { return std::max({dims().x(), dims().y(), dims().z()}); }
};

}  // namespace sherd
