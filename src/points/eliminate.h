// Weighted sample elimination: Poisson-disk subsets of points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Candidates per kept point.
inline constexpr std::size_t kCandidatesPerPoint = 5;

/// Returns the indices of `keep` well-separated points, ascending.  Drops the point with the
/// largest weight, a sum over its neighbors, until `keep` are left.
///   candidates  [keep * kCandidatesPerPoint] uniform over a surface
///   area        of that surface, world units squared, > 0
///   source      Yuksel, Sample Elimination for Generating Poisson Disk Sample Sets, 2015
[[nodiscard]] std::vector<std::size_t> eliminated(std::span<const glm::dvec3> candidates,
                                                  std::size_t keep, double area);

}  // namespace sherd
