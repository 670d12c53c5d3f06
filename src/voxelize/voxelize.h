// Voxelization within a limit of work.
#pragma once

#include <sherd/solid.h>

#include <memory>

namespace sherd {

/// As voxelize(), but an open mesh that `options` leave to Fill::automatic is made a shell after a
/// share of the usual work.
[[nodiscard]] Solid voxelizeWithin(const TriangleMesh& mesh, const SolidOptions& options,
                                   double workShare, const Progress* progress = nullptr);

/// As voxelize(), without the solid on which cracks are decided: it has no region beyond its own.
[[nodiscard]] Solid voxelizeAlone(const TriangleMesh& mesh, const SolidOptions& options,
                                  const Progress* progress);

/// Returns the level set of what a mesh encloses, by its winding number, in a given grid.
[[nodiscard]] std::shared_ptr<openvdb::FloatGrid> levelSetIn(const TriangleMesh& mesh,
                                                             const GridFrame& frame,
                                                             const Progress* progress = nullptr);

}  // namespace sherd
