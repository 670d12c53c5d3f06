// Vertices that two meshes have in common.
#pragma once

#include <sherd/progress.h>

#include <span>

#include "evaluate/cracks/fragment_shape.h"

namespace sherd {

/// Returns the share of the vertices of triangles that have a vertex of another mesh within a
/// distance.
[[nodiscard]] double coincidentShare(std::span<const DividedMesh> meshes, double distance,
                                     const Progress* progress);

}  // namespace sherd
