// The last check of sampled points.
#pragma once

#include <sherd/points.h>

namespace sherd {

/// Checks that points and normals are finite.
///   return    the points
///   fragment  whose they are
///   throws    Error(internal), which names the fragment and the stage "points"
[[nodiscard]] SurfacePoints checkedPoints(SurfacePoints points, int fragment);

}  // namespace sherd
