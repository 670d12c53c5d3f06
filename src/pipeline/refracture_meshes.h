// Exact meshes of a fracture that is broken again.
#pragma once

#include <sherd/fracture.h>

#include <cstdint>
#include <span>
#include <vector>

#include "surface/exact/exact_surface.h"

namespace sherd {

/// A fragment of a finished fracture after it was broken.
struct BrokenFragment {
  int id = 0;                        ///< in the finished fracture
  std::vector<std::uint16_t> ids{};  ///< [parts + 1] those of its parts, [0] is 0
  Solid solid;                       ///< of the fragment alone, with an exterior band
  Labels labels;                     ///< of its parts, 1, 2, ...
  ExactSurface surface{};            ///< of its parts, by cutAgain()
};

/// Returns the faces of one fragment, without neighbors, and their indices in `finished.faces` as
/// SolidMesh::source; none where it has no mesh.
[[nodiscard]] SolidMesh meshOf(const FinishedFracture& finished, int id);

/// Sets the exterior band to the voxels of the blocks' leaves that are not inside, and at most
/// kHalfWidthVoxels steps over faces and edges away from one that is.
void setExteriorBand(LeafBlocks& blocks);

/// Cuts the mesh of a broken fragment, to whose parts' meshes their labels may give way
/// (settledExactMeshes).
///   adaptivity  SurfaceOptions::adaptivity
void cutAgain(const FinishedFracture& finished, BrokenFragment& broken, double adaptivity,
              const Progress* progress);

/// Returns the meshes of all new fragments: the faces of those that were kept, and the faces of the
/// broken ones, cut.  TriangleMesh::source is an index in the mesh of
/// `finished.source`.
///   broken  cut; its surfaces are taken
///   labels  of all new fragments; those that were kept have the ids of before
///   return  a failure where a mesh is missing, open, or can't be cut
[[nodiscard]] ExactSurface exactMeshesAgain(const FinishedFracture& finished,
                                            std::span<BrokenFragment> broken, const Labels& labels);

}  // namespace sherd
