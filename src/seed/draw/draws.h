// The numbers of draws, and their points.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "base/random.h"

namespace sherd {

/// Returns a point of the unit cube: items item * 3 .. item * 3 + 2 of a stage.
[[nodiscard]] inline glm::dvec3 randomPoint(std::uint64_t seed, Stage stage, std::uint64_t item) {
  return {randomUnit(seed, stage, 3 * item), randomUnit(seed, stage, 3 * item + 1),
          randomUnit(seed, stage, 3 * item + 2)};
}

/// The number of a draw: each seed has numbers of its own, so that one that is drawn again moves no
/// other.
[[nodiscard]] constexpr std::uint64_t drawItem(std::uint64_t seedNumber, std::uint64_t draw) {
  return seedNumber << 20 | draw;  // draws are below 2^20
}

}  // namespace sherd
