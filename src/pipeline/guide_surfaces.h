// The surfaces of given cracks.
#pragma once

#include <sherd/fracture.h>

#include <span>
#include <vector>

#include "mesh/sided_mesh.h"

namespace sherd {

/// Returns a surface for each polyline and each connected component of the guides' meshes, in this
/// order, guide by guide.
///   throws  Error(input) naming the guide: a polyline without a length or far from the solid, a
///           value that is not finite, nothing in it; Error(cancelled)
[[nodiscard]] std::vector<SidedMesh> guideSurfacesOf(std::span<const Guide> guides,
                                                     const Solid& solid,
                                                     const Progress* progress = nullptr);

}  // namespace sherd
