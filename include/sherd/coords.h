// Points that know their space, and the frame that joins index space to the mesh's own space.
#pragma once

#include <sherd/grid_fwd.h>

#include <algorithm>
#include <glm/vec3.hpp>

namespace sherd {

/// A position that knows its space: mixing spaces does not compile.
template <class Space>
struct Point {
  glm::dvec3 v{0.0};
};
using WorldPoint = Point<struct WorldSpace>;  ///< the mesh's own length unit
using IndexPoint = Point<struct IndexSpace>;  ///< voxels; voxel centres at integers

/// Where the voxels lie: voxel (i,j,k) has its centre at origin + voxelSize * (i,j,k).
/// The grid is laid from the mesh's box, so `origin` is the box's lower corner plus half a voxel.
struct GridFrame {
  WorldPoint origin;       ///< world position of voxel (0,0,0)'s centre
  double voxelSize = 1.0;  ///< world units per voxel, > 0

  IndexPoint indexFromWorld(WorldPoint p) const { return {(p.v - origin.v) / voxelSize}; }
  WorldPoint worldFromIndex(IndexPoint p) const { return {origin.v + voxelSize * p.v}; }
};

/// Voxels min..max, both included.
struct VoxelBox {
  openvdb::Coord min{0, 0, 0};
  openvdb::Coord max{-1, -1, -1};

  bool empty() const { return max.x() < min.x(); }
  openvdb::Coord dims() const { return max - min + openvdb::Coord(1, 1, 1); }
  int longestSide() const { return std::max({dims().x(), dims().y(), dims().z()}); }
};

}  // namespace sherd
