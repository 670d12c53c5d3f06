// Points at which the faces of a complex cannot bound solids.
#pragma once

#include <sherd/progress.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "intersect/self_crossings.h"
#include "remesh/complex.h"

namespace sherd {

struct ComplexFault {
  glm::dvec3 at{0.0};
  std::array<std::uint32_t, 2> faces{};  ///< two that take part
};

/// Returns where faces cross each other, or a label other than 0 has more than two faces at an
/// edge; nothing if the surface has no such faults.
///   tested  the pairs of faces that are looked at for crossings
///   throws  Error(cancelled)
[[nodiscard]] std::vector<ComplexFault> faultsOf(const LabeledComplex& complex,
                                                 const CrossingPairs& tested,
                                                 const Progress* progress = nullptr);

}  // namespace sherd
