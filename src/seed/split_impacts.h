// Impacts whose pattern of cracks is made by splits.
#pragma once

#include <sherd/seeds.h>

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "seed/impact_rings.h"

namespace sherd {

/// An impact with an energy: radial cracks through its center, and rings about it.
struct SplitImpact {
  glm::dvec3 center{0.0};     ///< index space: in the middle of a thin wall, else on the surface
  glm::dvec3 u{0.0}, v{0.0};  ///< unit vectors at right angles to each other and to the surface
  RingPattern pattern{};
  std::uint32_t component = 0;
  std::size_t pieces = 0;  ///< that come of it, as far as there are any
  std::uint64_t seed = 0;  ///< of its random numbers

  /// Returns the radius of the ring crack that bounds the pattern.
  [[nodiscard]] double outerRadius() const { return pattern.radius * pattern.ratio; }
};

/// Returns the impacts that have an energy.
///   pieces  number of fragments
///   throws  Error(usage) an impact misses, or has a value out of range
[[nodiscard]] std::vector<SplitImpact> splitImpacts(const Solid& solid,
                                                    const VoxelComponents& components,
                                                    const SeedOptions& options, std::size_t pieces);

}  // namespace sherd
