// Ways to the middle of walls that lead anywhere.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "voxelize/wall_middles.h"

namespace sherd {

// Ways in all directions, up to three voxels long.
inline std::shared_ptr<const WallMiddles> randomWays(
    const std::shared_ptr<const LeafBlocks>& blocks) {
  std::mt19937 random(11);
  std::vector<std::int16_t> ways(blocks->count() * 512 * 3);
  for (std::int16_t& way : ways) {
    way = static_cast<std::int16_t>(static_cast<int>(random() % 385) - 192);
  }
  return std::make_shared<const WallMiddles>(blocks, std::move(ways));
}

}  // namespace sherd
