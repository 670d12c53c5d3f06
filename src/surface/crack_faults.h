// Points where a crack surface is not fit to cut a mesh.
#pragma once

#include <sherd/progress.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "surface/crack_surface.h"

namespace sherd {

/// Returns points where faces cross each other, or a label has more than two faces at an edge; none
/// if the surface has no such faults.
///   of      [faces] 0 or 1: looks for crossings of the faces with 1 only
///   throws  Error(cancelled)
[[nodiscard]] std::vector<glm::dvec3> faultsOf(const CrackSurface& cracks,
                                               std::span<const std::uint8_t> of,
                                               const Progress* progress = nullptr);

}  // namespace sherd
