// Faces that single precision spoils.
#pragma once

#include <sherd/progress.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "clean/stars.h"

namespace sherd {

/// Positions of vertices, and what files of single precision round them to.
struct CleanPositions {
  std::vector<glm::dvec3> exact;
  std::vector<glm::dvec3> rounded{};  ///< empty: files of single precision do not matter
  double spacing = 0.0;               ///< of floats where they are farthest apart
};

/// Returns which of a few faces have no area or cross a face with a common vertex once they are
/// rounded, decided exactly.  Nearly all pairs are apart by far more than rounding moves them,
/// which costs a few products.
///   isFixed   [vertices] pairs of faces that have only such corners are the mesh's own, and left
///   out vertices  whose faces are tested return    faces that are CleanFace::isPrimary, ascending
///   throws    Error(cancelled)
[[nodiscard]] std::vector<std::uint32_t> roundedFaults(const Stars& stars,
                                                       const CleanPositions& positions,
                                                       const std::vector<bool>& isFixed,
                                                       std::span<const std::uint32_t> vertices,
                                                       const Progress* progress = nullptr);

}  // namespace sherd
