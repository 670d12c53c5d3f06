// The surface that closes a mesh's holes.
#pragma once

#include <sherd/mesh.h>

#include "mesh/triangle_tree.h"
#include "voxelize/generalised_winding.h"

namespace sherd {

/// The surface where a mesh winds half way round and has no triangle: what closes its holes.  It
/// begins at the mesh's boundary, whence it is followed from voxel to voxel; a vertex for each cell
/// that it passes, as surface nets have it.
///   winding  of the mesh
///   tree     of the mesh, in index space
///   return   in index space; to within a voxel of the mesh's own triangles
///   throws   Error(cancelled)
/// source  Gibson, Constrained Elastic Surface Nets, 1998
[[nodiscard]] TriangleMesh holeSurface(const GeneralisedWinding& winding, const TriangleTree& tree,
                                       const Progress* progress = nullptr);

}  // namespace sherd
