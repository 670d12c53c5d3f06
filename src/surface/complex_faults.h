// Points at which the faces of a complex cannot bound solids.
#pragma once

#include <sherd/progress.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "surface/complex.h"

namespace sherd {

/// Returns points where faces cross each other, or a label other than 0 has more than two faces at
/// an edge; none if the surface has no such faults.
///   of      [faces] 0 or 1: looks for crossings of the faces with 1 only
///   throws  Error(cancelled)
[[nodiscard]] std::vector<glm::dvec3> faultsOf(const Complex& complex,
                                               std::span<const std::uint8_t> of,
                                               const Progress* progress = nullptr);

}  // namespace sherd
