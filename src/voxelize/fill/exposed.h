// The parts of a mesh that bound its solid.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include "voxelize/fill/generalized_winding.h"

namespace sherd {

/// Returns the parts of a mesh's triangles that have the solid on one side only: where the
/// generalized winding number is at least 0.5 on exactly one side.  Triangles that lie partly
/// within the solid are subdivided down to a quarter of a voxel.
///   mesh     in index space
///   winding  of the mesh, not simple
///   throws   Error(cancelled); TooMuchWork, by the winding's limit
[[nodiscard]] TriangleMesh exposedSurface(const TriangleMesh& mesh,
                                          const GeneralizedWinding& winding,
                                          const Progress* progress);

}  // namespace sherd
