// Labels of a leaf and its surroundings, and the cells that surfaces pass through.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "voxelize/leaves/leaf_blocks.h"

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
  // Of the leaf below, the leaf itself and the leaf above along an axis: the first layer within the
  // leaf, the number of layers, and the first layer in the cube.
  constexpr std::array<std::size_t, 3> kFrom{8 - kBelow, 0, 0}, kCount{kBelow, 8, kAbove},
      kTo{0, kBelow, kBelow + 8};
  LabelCube<kSide> cube;
  // The part along z is a compile-time constant, so that labels are copied as words.
  const auto take = [&]<std::size_t kZ>(std::size_t xPart, std::size_t yPart) {
    constexpr std::size_t kRow = kCount[kZ];
    if constexpr (kRow == 0) return;
    const std::uint32_t leaf = neighborhood[xPart * 9 + yPart * 3 + kZ];
    for (std::size_t x = 0; x < kCount[xPart]; ++x) {
      for (std::size_t y = 0; y < kCount[yPart]; ++y) {
        std::uint16_t* const to =
            &cube[((kTo[xPart] + x) * kSide + kTo[yPart] + y) * kSide + kTo[kZ]];
        if (leaf == LeafBlocks::kNone) {
          std::fill_n(to, kRow, std::uint16_t{0});
          continue;
        }
        const std::size_t row = (kFrom[xPart] + x) * 8 + kFrom[yPart] + y;
        const std::uint16_t* const from =
            &labels.fragment[std::size_t{leaf} * 512 + row * 8 + kFrom[kZ]];
        if (voxels == Voxels::all) {
          std::copy_n(from, kRow, to);
          continue;
        }
        const auto bits = (blocks.inside[leaf * 8 + row / 8] >> (row % 8 * 8)) & 0xff;
        const std::uint16_t* const mask = &kBitMasks[bits][kFrom[kZ]];
        for (std::size_t i = 0; i < kRow; ++i)
          to[i] = static_cast<std::uint16_t>(from[i] & mask[i]);
      }
    }
  };
  for (std::size_t xPart = 0; xPart < 3; ++xPart) {
    for (std::size_t yPart = 0; yPart < 3; ++yPart) {
      take.template operator()<0>(xPart, yPart);
      take.template operator()<1>(xPart, yPart);
      take.template operator()<2>(xPart, yPart);
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
[[nodiscard]] constexpr PassedCells<kSide> passedCells(const LabelCube<kSide>& labels) {
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
  least.back() = high.back() = labels.back();  // of no cell, but read below
  low.back() = less1(labels.size() - 1);
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
