// The last check of sampled points.
#pragma once

#include <sherd/points.h>

#include "points/blocks.h"

namespace sherd {

/// Checks that points and normals are finite.
///   fragment  whose they are
///   throws    Error(internal), which names the fragment and the stage "points"
void requireFinite(const SurfacePoints& points, int fragment);

/// The same blocks, checked as they are read.
[[nodiscard]] Blocks<SurfacePoints> finite(Blocks<SurfacePoints> points, int fragment);

}  // namespace sherd
