// Merges planes, then collapses edges, in voxels.
#include "remesh/decimate/simplified_cracks.h"

#include <sherd/fragments.h>

#include <algorithm>
#include <cstddef>
#include <glm/common.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "remesh/decimate/crack_overhang.h"
#include "remesh/decimate/decimate.h"
#include "remesh/decimate/merge_facets.h"

namespace sherd {
namespace {

// Index space, rounded so that what is decided by positions does not depend on the frame.
std::vector<glm::dvec3> gridInVoxels(std::vector<glm::dvec3> world, const GridFrame& frame) {
  constexpr double kGrid = 0x1p-24;
  for (glm::dvec3& v : world) v = kGrid * glm::round(frame.indexFromWorld(v) / kGrid);
  return world;
}

// The least height of a face that collapses change, voxels, unless it had less before.
constexpr double kLeastCrackHeight = 0.02;

}  // namespace

LabeledComplex simplifiedCracks(const LabeledComplex& cracks, const TriangleMesh& mesh,
                                const GridFrame& frame, const CrackSimplification& options,
                                const Progress* progress) {
  if (cracks.faces.empty()) return cracks;
  FacetOptions facets{.cracks = {.tolerance = kPlanarCrackTolerance * frame.voxelSize}};
  if (options.adaptivity == 0.0) facets.cracks.leastFaces = std::numeric_limits<std::size_t>::max();
  LabeledComplex merged = withMergedFacets(cracks,
                                           {.mostFaults = mostFaultsOf(cracks.faces.size()),
                                            .facets = facets,
                                            .displacementSeed = options.displacementSeed},
                                           progress)
                              .complex;
  if (options.adaptivity == 0.0) return merged;
  static_assert(kAutoAdaptivity < kPlanarCrackTolerance);
  const CrackOverhang overhang({gridInVoxels(mesh.vertices, frame), mesh.triangles});
  merged.vertices = gridInVoxels(std::move(merged.vertices), frame);
  LabeledComplex simple =
      collapsed(merged,
                {.error = std::max(options.adaptivity, kPlanarCrackTolerance),
                 .leastHeight = kLeastCrackHeight,
                 .mayMove = [&](const auto& from, const auto& to,
                                const auto& end) { return overhang.mayMove(from, to, end); }},
                progress);
  for (glm::dvec3& v : simple.vertices) v = frame.worldFromIndex(v);
  return simple;
}

}  // namespace sherd
