// Seeds of an impact on a thin wall: rings about its point, cut by radial cracks.
#pragma once

#include <sherd/seeds.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "seed/draw/wall.h"

namespace sherd {

inline constexpr double kLeastEnergy = 0.01, kMostEnergy = 100.0;

/// The cracks of an impact.
struct RingPattern {
  int radials = 0;      ///< radial cracks
  int rings = 0;        ///< ring cracks; there is one more row of seeds
  double ratio = 0.0;   ///< of the radii of one ring and the next
  double radius = 0.0;  ///< of the last ring crack

  /// Returns the radius of the seeds of a row, 0..rings: ring cracks lie half way between two rows.
  [[nodiscard]] double rowRadius(int row) const;
  [[nodiscard]] std::size_t seeds() const {
    return static_cast<std::size_t>(radials) * (static_cast<std::size_t>(rings) + 1);
  }
};

/// Returns the pattern for an energy: 8 energy^(1/4) radial cracks, because their number grows by
/// the square root of the speed; and 3 energy^(1/4) rings, each wider than the one before by as
/// much as a sector is wide there.
///   side    longest side of the solid
///   radius  of the last ring; 0: side / 4 energy^(1/8)
///   source  Vandenberghe, Vermorel and Villermaux, Star-shaped crack pattern of broken windows,
///   PRL
///           110, 174302, 2013 (the radial cracks)
[[nodiscard]] RingPattern ringPatternFor(double energy, double side, double radius);

/// Returns the seeds' points in the middle of the wall, one row after another from the impact, in
/// index space; without those that would lie beyond the edge of the wall.  None where the solid at
/// the impact is thicker than half the radius.
///   at    on the surface
///   seed  of the impact
[[nodiscard]] std::vector<glm::dvec3> ringPoints(const RingPattern& pattern, const Walls& walls,
                                                 const glm::dvec3& at, std::uint64_t seed);

/// Returns `count` of the points: all of the inner rows, and of the next row evenly spread ones.
[[nodiscard]] std::vector<glm::dvec3> innerPoints(const std::vector<glm::dvec3>& points,
                                                  const RingPattern& pattern, std::size_t count);

}  // namespace sherd
