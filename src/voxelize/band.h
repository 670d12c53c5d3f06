// Distances from voxels to a surface, in a band around it.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <array>
#include <vector>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// A leaf of 8x8x8 voxels, in OpenVDB's order.
struct BandLeaf {
  openvdb::Coord origin;
  std::array<float, 512> distance;  ///< voxels, >= 0; infinite where not below `reach`
};

/// Returns the leaves that have a voxel nearer than `reach` to a surface, with their distances.
///
/// Cubes of voxels are halved from a side of 64 down; a cube is skipped when its center is too far
/// from the surface for any of its voxels to be near.  So the cost grows with the surface's area in
/// voxels, and hardly depends on the number of triangles.
///   tree     of the surface, in index space, not empty
///   reach    voxels
///   return   in an order that does not depend on the number of threads
///   throws   Error(cancelled)
[[nodiscard]] std::vector<BandLeaf> bandOf(const TriangleTree& tree, double reach,
                                           const Progress* progress);

}  // namespace sherd
