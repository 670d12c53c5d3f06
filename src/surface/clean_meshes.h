// Meshes of exact surfaces without short edges and thin triangles.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <algorithm>
#include <vector>

#include "clean/clean.h"
#include "surface/complex.h"

namespace sherd {

/// How near to each other vertices and edges of exact surfaces may be: voxels, and of the longest
/// side.
inline constexpr double kCleanVoxels = 1e-3, kCleanShare = 2e-5;

/// Returns the tolerances of a solid's pieces.
[[nodiscard]] inline CleanOptions cleanOptions(const Solid& solid) {
  const double side = solid.box.longestSide() * solid.frame.voxelSize;
  return {.tolerance = std::max(kCleanVoxels * solid.frame.voxelSize, kCleanShare * side)};
}

/// Cleans the meshes of exactSurface.
///   meshes  with TriangleMesh::source by `cut`; LabeledMesh::positionId is the index of a vertex
///           of `cut` for its vertices
[[nodiscard]] std::vector<LabeledMesh> withoutSlivers(std::vector<LabeledMesh> meshes,
                                                      const TriangleMesh& cut,
                                                      const CleanOptions& options,
                                                      const Progress* progress = nullptr);

}  // namespace sherd
