// Points where a crack surface is not fit to cut a mesh.
#pragma once

#include <sherd/progress.h>

#include <glm/vec3.hpp>
#include <vector>

#include "surface/crack_surface.h"

namespace sherd {

/// Returns points where faces cross each other, or a label has more than two faces at an edge; none
/// if the surface has no such faults.
///   throws  Error(cancelled)
[[nodiscard]] std::vector<glm::dvec3> faultsOf(const CrackSurface& cracks,
                                               const Progress* progress = nullptr);

}  // namespace sherd
