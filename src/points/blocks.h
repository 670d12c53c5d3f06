// Samples in blocks, so that their number does not decide how much memory they take.
#pragma once

#include <sherd/points.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace sherd {

/// The most samples of a block.
inline constexpr std::size_t kSamplesPerBlock = std::size_t{1} << 18;

/// A sequence that is made block by block, as often as it is read.
template <class Block>
struct Blocks {
  std::size_t count = 0;  ///< of all blocks

  /// Calls visit(block) for each block in order, at least once.
  std::function<void(const std::function<void(const Block&)>& visit)> forEach{};
};

/// Passes on what is in memory as one block; keeps a reference.
template <class Block>
Blocks<Block> oneBlock(const Block& all) {
  return {all.positions.size(), [&all](const auto& visit) { visit(all); }};
}

/// Calls visit(first, end) for the blocks of a sequence, at least once.
template <class Visit>
void forEachBlock(std::size_t count, const Visit& visit) {
  std::size_t first = 0;
  do {
    const std::size_t end = first + std::min(kSamplesPerBlock, count - first);
    visit(first, end);
    first = end;
  } while (first < count);
}

/// Distance samples, whose positions are made again without the distances, which cost far more.
struct DistanceBlocks {
  Blocks<DistanceSamples> samples{};
  std::function<void(const std::function<void(std::span<const glm::dvec3>)>& visit)>
      forEachPositions{};
  SampleType type = SampleType::float32;
};

}  // namespace sherd
