// Voxelization within a limit of work.
#pragma once

#include <sherd/solid.h>

namespace sherd {

/// As voxelize(), but an open mesh that `options` leave to Fill::automatic is made a shell after a
/// share of the usual work.
[[nodiscard]] Solid voxelizeWithin(const TriangleMesh& mesh, const SolidOptions& options,
                                   double workShare, const Progress* progress = nullptr);

}  // namespace sherd
