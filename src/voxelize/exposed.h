// Which of a mesh's surfaces bound its solid.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include "voxelize/generalised_winding.h"

namespace sherd {

/// The pieces of a mesh's triangles that have the solid on one side only: where the generalised
/// winding number is a half or more behind them and less before them, or the other way round.
/// Triangles that lie partly within the solid are cut into pieces down to a quarter of a voxel.
///   mesh     in index space
///   winding  of the mesh, not simple
///   throws   Error(cancelled)
[[nodiscard]] TriangleMesh exposedSurface(const TriangleMesh& mesh,
                                          const GeneralisedWinding& winding,
                                          const Progress* progress);

}  // namespace sherd
