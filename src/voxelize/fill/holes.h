// The surface that closes a mesh's holes.
#pragma once

#include <sherd/mesh.h>

#include "mesh/search/triangle_tree.h"
#include "voxelize/fill/generalized_winding.h"

namespace sherd {

/// Returns the surface that closes a mesh's holes: where the generalized winding number is 0.5 and
/// the mesh has no triangle.  It is traced from the mesh's boundary from voxel to voxel, with a
/// vertex in each cell that it passes, as in surface nets.
///   winding  of the mesh
///   tree     of the mesh, in index space
///   return   in index space; ends within a voxel of the mesh's triangles
///   throws   Error(cancelled); TooMuchWork, by the winding's limit
/// source  Gibson, Constrained Elastic Surface Nets, 1998
[[nodiscard]] TriangleMesh holeSurface(const GeneralizedWinding& winding, const TriangleTree& tree,
                                       const Progress* progress = nullptr);

}  // namespace sherd
