// Labels of a leaf and its surroundings, and the cells that surfaces pass through.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "voxelize/leaf_blocks.h"

namespace sherd {

/// Labels of a cube of voxels, x, y, z with z fastest.
template <std::size_t kSide>
using LabelCube = std::array<std::uint16_t, kSide * kSide * kSide>;

/// [byte] 0xffff for each of its bits that is set
inline constexpr std::array<std::array<std::uint16_t, 8>, 256> kBitMasks = [] {
  std::array<std::array<std::uint16_t, 8>, 256> masks{};
  for (std::size_t byte = 0; byte < 256; ++byte) {
    for (std::size_t bit = 0; bit < 8; ++bit) {
      masks[byte][bit] = (byte >> bit) & 1 ? std::uint16_t{0xffff} : std::uint16_t{0};
    }
  }
  return masks;
}();

enum class Voxels {
  all,    ///< in the exterior band too
  inside  ///< others are 0
};

/// Returns the labels of a leaf and of kBelow layers below and kAbove layers above it along each
/// axis; 0 where there is no leaf.
template <std::size_t kBelow, std::size_t kAbove>
[[nodiscard]] LabelCube<kBelow + 8 + kAbove> labelsAround(const LeafBlocks& blocks,
                                                          const Labels& labels,
                                                          const LeafNeighbors& neighborhood,
                                                          Voxels voxels) {
  constexpr std::size_t kSide = kBelow + 8 + kAbove;
  LabelCube<kSide> cube;
  std::uint16_t* to = cube.data();
  // Counts are compile-time constants, so that labels are copied as words.
  const auto take = [&]<std::size_t kFrom, std::size_t kCount>(std::uint32_t leaf,
                                                               std::size_t row) {
    if (leaf == LeafBlocks::kNone) {
      to = std::fill_n(to, kCount, std::uint16_t{0});
      return;
    }
    const std::uint16_t* const from = &labels.fragment[std::size_t{leaf} * 512 + row * 8 + kFrom];
    std::copy_n(from, kCount, to);
    if (voxels == Voxels::inside) {
      const auto bits = (blocks.inside[leaf * 8 + row / 8] >> (row % 8 * 8)) & 0xff;
      for (std::size_t i = 0; i < kCount; ++i) to[i] &= kBitMasks[bits][kFrom + i];
    }
    to += kCount;
  };
  for (std::size_t x = 8 - kBelow; x < 16 + kAbove; ++x) {
    for (std::size_t y = 8 - kBelow; y < 16 + kAbove; ++y) {
      // The row spans three leaves.
      const std::uint32_t* const leaves = &neighborhood[x / 8 * 9 + y / 8 * 3];
      const std::size_t row = x % 8 * 8 + y % 8;
      if constexpr (kBelow > 0) take.template operator()<8 - kBelow, kBelow>(leaves[0], row);
      take.template operator()<0, 8>(leaves[1], row);
      if constexpr (kAbove > 0) take.template operator()<0, kAbove>(leaves[2], row);
    }
  }
  return cube;
}

/// The lowest and the highest label other than 0.
struct LabelRange {
  std::uint16_t below = 0xffff;  ///< the lowest minus 1
  std::uint16_t high = 0;        ///< 0 if there is none

  bool isOne() const { return high != 0 && below == high - 1; }
  bool isSeveral() const { return below < static_cast<std::uint16_t>(high - 1); }
};

[[nodiscard]] inline LabelRange rangeOf(std::span<const std::uint16_t> labels) {
  LabelRange range;
  for (const std::uint16_t label : labels) {
    range.below = std::min(range.below, static_cast<std::uint16_t>(label - 1));
    range.high = std::max(range.high, label);
  }
  return range;
}

/// The cells of a cube that surfaces pass through, by their lowest corners: [x*kSide+y] bit z.
template <std::size_t kSide>
struct PassedCells {
  using Rows = std::array<std::uint16_t, kSide * kSide>;
  Rows crossed{};  ///< its corners' labels differ
  Rows cut{};      ///< its corners have several labels other than 0
};

template <std::size_t kSide>
[[nodiscard]] PassedCells<kSide> passedCells(const LabelCube<kSide>& labels) {
  // By the lowest corner of a cell: the lowest label, the lowest other than 0 minus 1, the highest.
  LabelCube<kSide> least, low, high;
  const auto gather = [&](const auto& fromLeast, const auto& fromLow, const auto& fromHigh,
                          std::size_t stride) {
    for (std::size_t i = 0; i + stride < labels.size(); ++i) {
      least[i] = std::min(fromLeast(i), fromLeast(i + stride));
      low[i] = std::min(fromLow(i), fromLow(i + stride));
      high[i] = std::max(fromHigh(i), fromHigh(i + stride));
    }
  };
  const auto label = [&](std::size_t i) { return labels[i]; };
  const auto less1 = [&](std::size_t i) { return static_cast<std::uint16_t>(labels[i] - 1); };
  gather(label, less1, label, 1);
  for (const std::size_t stride : {kSide, kSide * kSide}) {
    gather([&](std::size_t i) { return least[i]; }, [&](std::size_t i) { return low[i]; },
           [&](std::size_t i) { return high[i]; }, stride);
  }
  PassedCells<kSide> cells;
  for (std::size_t x = 0; x + 1 < kSide; ++x) {
    for (std::size_t y = 0; y + 1 < kSide; ++y) {
      const std::size_t row = x * kSide + y;
      unsigned crossed = 0, cut = 0;
      for (std::size_t z = 0; z + 1 < kSide; ++z) {
        const std::size_t i = row * kSide + z;
        crossed |= static_cast<unsigned>(least[i] != high[i]) << z;
        cut |= static_cast<unsigned>(low[i] < static_cast<std::uint16_t>(high[i] - 1)) << z;
      }
      cells.crossed[row] = static_cast<std::uint16_t>(crossed);
      cells.cut[row] = static_cast<std::uint16_t>(cut);
    }
  }
  return cells;
}

}  // namespace sherd
