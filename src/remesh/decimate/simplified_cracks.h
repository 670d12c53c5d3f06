// Cracks with few triangles, before they cut a mesh.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstdint>

#include "remesh/complex.h"

namespace sherd {

struct CrackSimplification {
  /// SurfaceOptions::adaptivity, voxels.  0: all faces stay.
  double adaptivity = 0.0;
  std::uint64_t displacementSeed = 0;
};

/// Returns the cracks with fewer faces, displaced at random by a thousandth of
/// kPlanarCrackTolerance.
///
/// Facets are merged within kPlanarCrackTolerance, then edges collapse as long as vertices are
/// within the adaptivity, root mean square, of the planes of the faces that they replace, planar,
/// bent and rough cracks alike.  kAutoAdaptivity, and any number below it, is
/// kPlanarCrackTolerance.  Cracks still end beyond the mesh.  Lines where they meet are shared.
/// What would cross itself keeps more faces.
///   cracks  of LabeledComplex::labels 0, without crossings, in world units
///   mesh    that they overhang, in world units
///   throws  Error(cancelled)
[[nodiscard]] LabeledComplex simplifiedCracks(const LabeledComplex& cracks,
                                              const TriangleMesh& mesh, const GridFrame& frame,
                                              const CrackSimplification& options,
                                              const Progress* progress = nullptr);

}  // namespace sherd
