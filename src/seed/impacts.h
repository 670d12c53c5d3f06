// Impacts: their centers, and the seeds scattered around them.
#pragma once

#include <sherd/seeds.h>

#include <optional>
#include <span>
#include <vector>

#include "seed/draw/samplers.h"
#include "seed/draw/voxel_index.h"
#include "seed/impact_rings.h"

namespace sherd {

/// An impact with its center, seed count and distribution resolved.
struct AimedImpact {
  glm::dvec3 center{0.0};       ///< index space
  std::uint32_t component = 0;  ///< of the nearest surface voxel
  std::size_t count = 0;        ///< seeds
  glm::dvec3 side{0.0};         ///< offset = side * meanOfUniforms(terms), voxels
  int terms = 0;
  std::vector<glm::dvec3> rings{};  ///< points of the first seeds, index space: of impacts with an
                                    ///< energy on thin walls
  RingPattern pattern{};            ///< of impacts with an energy
  bool merge = false;
};

/// Resolves the impacts: those of the options first, then the random ones.
///   pieces  number of fragments
///   throws  Error(usage) a value out of range, a ray that misses; Error(cancelled)
[[nodiscard]] std::vector<AimedImpact> aim(const Solid& solid, const VoxelComponents& components,
                                           const SeedOptions& options, std::size_t pieces,
                                           const VoxelIndex& inside, const VoxelIndex& surface,
                                           const Progress* progress = nullptr);

/// Returns the center of the first of the options' impacts, index space, if there are any.
///   throws  Error(usage) a ray that misses
[[nodiscard]] std::optional<IndexPoint> firstImpact(const Solid& solid, const SeedOptions& options);

/// Refuses points that are farther from the surface than kMostImpactDistance: they are not meant
/// for where they would strike.
///   throws  Error(usage) with the distance
void requireNearImpacts(const Solid& solid, std::span<const Impact> impacts);

/// Adds the seeds of an impact.
///   number       index of the impact from 0; each has its own random sequence
///   inComponent  candidates in the component of the impact
///   throws       Error(usage) too few free voxels in the component; Error(cancelled)
void scatter(const AimedImpact& aimedImpact, std::size_t number, const Candidates& candidates,
             std::uint64_t inComponent, std::uint64_t seed, Chosen& chosen,
             const Progress* progress);

}  // namespace sherd
