// Points well apart: of many, those that crowd others are dropped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// How many candidates elimination wants for each point that stays.
inline constexpr std::size_t kCandidatesPerPoint = 5;

/// The numbers of `keep` points that are well apart, ascending.  The point most crowded by those
/// within reach is dropped, again and again.
///   candidates  [keep * kCandidatesPerPoint], uniform over a surface
///   area        of that surface, world units squared, > 0
///   source      Yuksel, Sample Elimination for Generating Poisson Disk Sample Sets, 2015
[[nodiscard]] std::vector<std::size_t> eliminated(std::span<const glm::dvec3> candidates,
                                                  std::size_t keep, double area);

}  // namespace sherd
