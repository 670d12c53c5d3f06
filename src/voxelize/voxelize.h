// Voxelization of a mesh alone.
#pragma once

#include <sherd/solid.h>

#include <memory>

namespace sherd {

/// As voxelize(), without the solid on which cracks are decided: it has no region beyond its own.
///   workShare  an open mesh that `options` leave to Fill::automatic is made a shell after this
///              share of the usual work
[[nodiscard]] Solid voxelizeAlone(const TriangleMesh& mesh, const SolidOptions& options,
                                  double workShare, const Progress* progress);

/// Returns the level set of what a mesh encloses, by its winding number, in a given grid.
[[nodiscard]] std::shared_ptr<openvdb::FloatGrid> levelSetIn(const TriangleMesh& mesh,
                                                             const GridFrame& frame,
                                                             const Progress* progress = nullptr);

}  // namespace sherd
