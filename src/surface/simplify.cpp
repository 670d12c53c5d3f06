// Selects how meshes are simplified.
#include "surface/simplify.h"

#include <algorithm>
#include <glm/common.hpp>
#include <utility>

#include "interface/flat_input.h"
#include "interface/intact.h"
#include "remesh/decimate/decimate.h"
#include "remesh/decimate/merge_facets.h"
#include "remesh/smooth.h"

namespace sherd {
namespace {

// Facets of the original surface are planes of the input, and come out as exactly as numbers are
// rounded, however small, but for single vertices beside creases and cracks, which move back onto
// their planes.  Cracks between two seeds are planes too, but where their vertices would
// leave a voxel's center on the wrong side, these are up to a tenth of a voxel off.
FacetOptions facetsInVoxels() {
  constexpr std::size_t kLeastFaces = 16;
  return {
      .cracks = {.tolerance = kPlanarCrackTolerance, .leastFaces = kLeastFaces},
      .original = {
          .tolerance = kPlanarTolerance, .leastFaces = kLeastFaces, .planarFaces = kLeastFaces}};
}

// Moves vertices to index space, rounded so that what is decided by positions does not depend on
// the frame.  Returns them as they were.
std::vector<glm::dvec3> toVoxels(LabeledComplex& complex, const GridFrame& frame) {
  constexpr double kGrid = 0x1p-24;
  std::vector<glm::dvec3> world = complex.vertices;
  for (glm::dvec3& v : complex.vertices) v = kGrid * glm::round(frame.indexFromWorld(v) / kGrid);
  return world;
}

// Vertices that did not move keep their bits.
std::vector<LabeledMesh> mergedPlanes(LabeledComplex complex, const GridFrame& frame,
                                      const Progress* progress) {
  const std::vector<glm::dvec3> world = toVoxels(complex, frame);
  MergedFacets merged = withMergedFacets(
      complex, {.mostFaults = mostFaultsOf(complex.faces.size()), .facets = facetsInVoxels()},
      progress);
  LabeledComplex& after = merged.complex;
  for (std::size_t v = 0; v < after.vertices.size(); ++v) {
    const std::uint32_t source = merged.vertex[v];
    after.vertices[v] = after.vertices[v] == complex.vertices[source]
                            ? world[source]
                            : frame.worldFromIndex(after.vertices[v]);
  }
  std::vector<LabeledMesh> meshes = meshesOf(after.vertices, after.faces, after.labels);
  for (LabeledMesh& mesh : meshes) mesh.mesh.isMerged = true;
  return meshes;
}

}  // namespace

Simplification simplificationOf(const SurfaceOptions& options, const Solid& solid,
                                const IntactSurface* intact) {
  if (options.surface != Surface::smooth || hasNoise(options)) return {};
  if (options.adaptivity != kAutoAdaptivity) {
    return {.error = options.adaptivity * solid.frame.voxelSize};
  }
  const bool isFlat = intact != nullptr ? intact->isPiecewiseFlat : isPiecewiseFlat(solid);
  return {.mergesPlanes = isFlat, .frame = solid.frame};
}

std::vector<LabeledMesh> simplified(LabeledComplex complex, const Simplification& simplification,
                                    const Progress* progress) {
  if (simplification.error > 0.0) return simplified(complex, simplification.error, progress);
  return mergedPlanes(std::move(complex), simplification.frame, progress);
}

}  // namespace sherd
