// How far voxels are from a surface, where they are near it.
#pragma once

#include <sherd/grid_fwd.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <array>
#include <vector>

#include "mesh/triangle_tree.h"

namespace sherd {

/// Eight by eight by eight voxels, in OpenVDB's order.
struct BandLeaf {
  openvdb::Coord origin;
  std::array<float, 512> distance;  ///< voxels, >= 0; infinite where it is `reach` or more
};

/// The leaves that have a voxel nearer than `reach` to a surface, and its voxels' distances.
///
/// Cubes of voxels are halved from 64 down; one is left out when its middle is too far from the
/// surface for any of its voxels to be near.  So the cost goes with the surface's area in voxels,
/// and hardly with the number of triangles.
///   tree     of the surface, in index space, not empty
///   reach    voxels
///   return   in one order, whatever the number of threads
///   throws   Error(cancelled)
[[nodiscard]] std::vector<BandLeaf> bandOf(const TriangleTree& tree, double reach,
                                           const Progress* progress);

}  // namespace sherd
