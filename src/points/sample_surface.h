// Points on a surface by area.
#pragma once

#include <sherd/points.h>

#include "mesh/surface_by_area.h"

namespace sherd {

/// Checks the options.
///   throws  Error(usage)
void checkPointOptions(const PointOptions& options);

/// samplePoints of a surface; options.count > 0.
[[nodiscard]] SurfacePoints samplePoints(const SurfaceByArea& surface, const PointOptions& options);

/// Returns the options for the points of one fragment.
///   options  `seed` is the fracture's
///   id       0: the whole solid
[[nodiscard]] PointOptions pointOptionsOf(PointOptions options, int id);

}  // namespace sherd
