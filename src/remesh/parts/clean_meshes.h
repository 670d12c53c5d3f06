// Meshes of exact surfaces without short edges and thin triangles.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <vector>

#include "clean/clean.h"
#include "remesh/complex.h"

namespace sherd {

/// How near to each other vertices and edges of exact surfaces may be: voxels, of the longest side,
/// and spacings of the floats that files may round them to.
inline constexpr double kCleanVoxels = 1e-3, kCleanShare = 2e-5, kCleanSpacings = 4.0;

/// How far single precision may move vertices for pieces to be sound in it, voxels: as
/// kMostRoundingVoxels, above which there is a warning.
inline constexpr double kCleanRoundingVoxels = 0.01;

/// Returns the tolerances of a solid's pieces.  They are sound in single precision too, unless that
/// loses too much.
[[nodiscard]] CleanOptions cleanOptions(const Solid& solid);

/// Cleans the meshes of exactSurface.
///   meshes  with TriangleMesh::source by `cut`; LabeledMesh::positionId is the index of a vertex
///           of `cut` for its vertices
[[nodiscard]] std::vector<LabeledMesh> withoutSlivers(std::vector<LabeledMesh> meshes,
                                                      const TriangleMesh& cut,
                                                      const CleanOptions& options,
                                                      const Progress* progress = nullptr);

}  // namespace sherd
