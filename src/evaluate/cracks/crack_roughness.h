// Roughness and Hurst exponents of the cracks of a fracture.
#pragma once

#include <sherd/evaluate.h>

#include <optional>
#include <span>
#include <vector>

#include "evaluate/cracks/fragment_shape.h"

namespace sherd {

struct CrackRoughness {
  std::optional<double> rms{};  ///< of heights over the cracks' planes, by area, world units
  std::vector<RoughnessAlong> along{};
};

/// Measures each contact of two fragments once.
///   meshes       [n]
///   ids          [n] of the fragments
///   propagation  or absent: along the coordinate axes, each of the cracks within 37 degrees of it
///   spacing      of the heights, world units
///   throws       Error(cancelled)
[[nodiscard]] CrackRoughness roughnessOf(std::span<const DividedMesh> meshes,
                                         std::span<const int> ids,
                                         const std::optional<glm::dvec3>& propagation,
                                         double spacing, const Progress* progress);

}  // namespace sherd
