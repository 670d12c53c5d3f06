// What SurfaceOptions::adaptivity does to meshes.
#pragma once

#include <sherd/fragments.h>

#include <vector>

#include "remesh/complex.h"

namespace sherd {

struct Simplification {
  bool mergesPlanes = false;  ///< merges the triangles of planes, see kAutoAdaptivity
  GridFrame frame{};
  double error = 0.0;  ///< world units; above 0: decimates, see decimate.h

  [[nodiscard]] bool changesMeshes() const { return mergesPlanes || error > 0.0; }
};

/// Returns what the adaptivity is for a solid.
///   intact  of the solid, or null; affects only the speed
[[nodiscard]] Simplification simplificationOf(const SurfaceOptions& options, const Solid& solid,
                                              const IntactSurface* intact = nullptr);

/// Returns the simplified meshes of all labels, [labels].
///   throws  Error(cancelled)
[[nodiscard]] std::vector<LabeledMesh> simplified(LabeledComplex complex,
                                                  const Simplification& simplification,
                                                  const Progress* progress = nullptr);

}  // namespace sherd
