// Voxels of a leaf's halo as bits.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "cut/leaf_cut.h"

namespace sherd {

/// Bits of a halo's voxels by row, [x*12+y] bit z.
using HaloBits = std::array<std::uint16_t, kCutSide * kCutSide>;

/// Dilates voxels by kCutHalo along all axes.
inline HaloBits dilated(const HaloBits& voxels) {
  constexpr int kLast = kCutSide - 1;
  HaloBits rows{}, out{};
  for (int x = 0; x < kCutSide; ++x) {
    for (int y = 0; y < kCutSide; ++y) {
      unsigned bits = voxels[static_cast<std::size_t>(x * kCutSide + y)];
      if (bits == 0) continue;
      for (int k = 0; k < kCutHalo; ++k) bits |= bits << 1 | bits >> 1;
      for (int j = std::max(y - kCutHalo, 0); j <= std::min(y + kCutHalo, kLast); ++j) {
        rows[static_cast<std::size_t>(x * kCutSide + j)] |=
            static_cast<std::uint16_t>(bits & 0xfff);
      }
    }
  }
  for (int x = 0; x < kCutSide; ++x) {
    for (int i = std::max(x - kCutHalo, 0); i <= std::min(x + kCutHalo, kLast); ++i) {
      for (int y = 0; y < kCutSide; ++y) {
        out[static_cast<std::size_t>(i * kCutSide + y)] |=
            rows[static_cast<std::size_t>(x * kCutSide + y)];
      }
    }
  }
  return out;
}

/// The row of the halo that holds a row of the leaf.
inline std::size_t haloRow(std::size_t row) {
  return (row / 8 + kCutHalo) * kCutSide + row % 8 + kCutHalo;
}

}  // namespace sherd
