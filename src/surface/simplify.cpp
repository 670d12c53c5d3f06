// Selects how meshes are simplified.
#include "surface/simplify.h"

#include <algorithm>

#include "mesh/flat_share.h"
#include "surface/decimate.h"
#include "surface/intact.h"
#include "surface/merge_facets.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

// The share of its input's surface that is flat in a piecewise flat solid, at a scale of voxels,
// and of the solid: at a high resolution every triangle of a scan is flat.
constexpr double kLeastFlat = 0.5;
constexpr double kFlatVoxels = 0.5, kFlatShareOfSide = 0.002;

// Facets of the original surface are planes of the input, and come out as exactly as numbers are
// rounded, however small.  Cracks between two seeds are planes too, but where their vertices would
// leave a voxel's center on the wrong side, these are up to a tenth of a voxel off.
FacetOptions facetsFor(double voxelSize) {
  constexpr std::size_t kLeastFaces = 16;
  return {.cracks = {.tolerance = kPlanarCrackTolerance * voxelSize, .leastFaces = kLeastFaces},
          .original = {.tolerance = kPlanarTolerance * voxelSize,
                       .ofSmall = 1.0,
                       .leastFaces = kLeastFaces,
                       .planarFaces = kLeastFaces}};
}

}  // namespace

bool isPiecewiseFlat(const Solid& solid) {
  const TriangleTree* const input = solid.region ? solid.region->boundary() : nullptr;
  if (input == nullptr || !solid.hasLinearAttributes) return false;
  const double reach = std::max(kFlatVoxels, kFlatShareOfSide * solid.box.longestSide());
  return flatShare(*input, reach) >= kLeastFlat;
}

Simplification simplificationOf(const SurfaceOptions& options, const Solid& solid,
                                const IntactSurface* intact) {
  if (options.surface != Surface::smooth) return {};
  if (options.adaptivity != kAutoAdaptivity) {
    return {.error = options.adaptivity * solid.frame.voxelSize};
  }
  const bool isFlat = intact != nullptr ? intact->isPiecewiseFlat : isPiecewiseFlat(solid);
  return {.mergedVoxels = isFlat ? solid.frame.voxelSize : 0.0};
}

std::vector<LabeledMesh> simplified(const Complex& complex, const Simplification& simplification,
                                    const Progress* progress) {
  if (simplification.error > 0.0) return simplified(complex, simplification.error, progress);
  const Complex merged =
      withMergedFacets(complex, {.facets = facetsFor(simplification.mergedVoxels)}, progress);
  std::vector<LabeledMesh> meshes = meshesOf(merged.vertices, merged.faces, merged.labels);
  for (LabeledMesh& mesh : meshes) mesh.mesh.isMerged = true;
  return meshes;
}

}  // namespace sherd
