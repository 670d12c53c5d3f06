// Sets of cells.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// The cells of one leaf: [offset / 64] bit offset % 64.
using CellBits = std::array<std::uint64_t, 8>;

[[nodiscard]] inline bool has(const CellBits& cells, std::size_t offset) {
  return ((cells[offset / 64] >> (offset % 64)) & 1) != 0;
}

/// The edges that begin at the lowest corners of a leaf's cells: [axis] by cell.
using LeafEdges = std::array<CellBits, 3>;

/// Returns the edges of a leaf with one of some cells around them.
///   cellsOf  returns the cells of a leaf, or null if there are none: const CellBits*(std::size_t)
template <class CellsOf>
[[nodiscard]] LeafEdges edgesAround(const LeafNeighbors& neighborhood, const CellsOf& cellsOf) {
  constexpr std::size_t kSide = 9;                  // the leaf's cells, and those below them
  std::array<std::uint16_t, kSide * kSide> rows{};  // [x*9+y] bit z
  for (std::size_t slot = 0; slot < 8; ++slot) {
    const bool x = (slot & 4) != 0, y = (slot & 2) != 0, z = (slot & 1) != 0;  // the leaf's own
    const std::uint32_t leaf = neighborhood[(x ? 9u : 0u) + (y ? 3u : 0u) + (z ? 1u : 0u)];
    const CellBits* const cells = leaf == LeafBlocks::kNone ? nullptr : cellsOf(leaf);
    if (cells == nullptr) continue;
    for (std::size_t i = x ? 1 : 0; i < (x ? kSide : 1); ++i) {
      for (std::size_t j = y ? 1 : 0; j < (y ? kSide : 1); ++j) {
        const std::uint64_t bits = ((*cells)[(i + 7) % 8] >> (8 * ((j + 7) % 8))) & 0xff;
        rows[i * kSide + j] |= static_cast<std::uint16_t>(z ? bits << 1 : bits >> 7);
      }
    }
  }
  LeafEdges edges{};
  const auto add = [&](std::size_t axis, std::size_t x, std::size_t y, unsigned row) {
    edges[axis][x] |= std::uint64_t{(row >> 1) & 0xff} << (8 * y);
  };
  for (std::size_t x = 0; x < 8; ++x) {
    for (std::size_t y = 0; y < 8; ++y) {
      const unsigned own = rows[(x + 1) * kSide + y + 1], belowX = rows[x * kSide + y + 1],
                     belowY = rows[(x + 1) * kSide + y], belowBoth = rows[x * kSide + y];
      const unsigned aroundX = own | belowY, aroundY = own | belowX;
      add(0, x, y, aroundX | aroundX << 1);
      add(1, x, y, aroundY | aroundY << 1);
      add(2, x, y, own | belowX | belowY | belowBoth);
    }
  }
  return edges;
}

/// Some cells of a solid.
class CellSet {
 public:
  ///   leaves  their number in the solid
  explicit CellSet(std::size_t leaves) : slots_(leaves, kNone) {}

  /// Returns the cells of a leaf, or null if there are none.
  [[nodiscard]] const CellBits* of(std::size_t leaf) const {
    return slots_[leaf] == kNone ? nullptr : &bits_[slots_[leaf]];
  }

  [[nodiscard]] bool has(std::size_t leaf, std::size_t offset) const {
    return slots_[leaf] != kNone && sherd::has(bits_[slots_[leaf]], offset);
  }

  /// Returns the leaves with cells, ascending.
  [[nodiscard]] std::vector<std::uint32_t> leaves() const {
    std::vector<std::uint32_t> all;
    for (std::uint32_t leaf = 0; leaf < slots_.size(); ++leaf) {
      if (slots_[leaf] != kNone) all.push_back(leaf);
    }
    return all;
  }

  /// Adds the cells whose offsets along each axis from a cell are at most `reach`, 0..8.
  ///   neighborhood  of the cell's leaf
  void addAround(const LeafNeighbors& neighborhood, unsigned offset, int reach) {
    const auto x = static_cast<int>(offset >> 6), y = static_cast<int>((offset >> 3) & 7),
               z = static_cast<int>(offset & 7);
    const std::uint32_t row = ((2u << (2 * reach)) - 1) << (z + 8 - reach);
    for (int i = x - reach; i <= x + reach; ++i) {
      for (int j = y - reach; j <= y + reach; ++j) addRow(neighborhood, i, j, row);
    }
  }

  /// Returns the cells of the set and all that touch them.
  [[nodiscard]] CellSet grown(std::span<const LeafNeighbors> neighborhoods) const {
    CellSet out(slots_.size());
    for (std::size_t leaf = 0; leaf < slots_.size(); ++leaf) {
      if (slots_[leaf] == kNone) continue;
      const CellBits& own = bits_[slots_[leaf]];
      for (int x = 0; x < 8; ++x) {
        for (int y = 0; y < 8; ++y) {
          const auto row =
              static_cast<std::uint32_t>((own[static_cast<std::size_t>(x)] >> (8 * y)) & 0xff) << 8;
          if (row == 0) continue;
          for (int i = x - 1; i <= x + 1; ++i) {
            for (int j = y - 1; j <= y + 1; ++j)
              out.addRow(neighborhoods[leaf], i, j, row << 1 | row | row >> 1);
          }
        }
      }
    }
    return out;
  }

  /// Removes the cells that another set does not have.
  void intersect(const CellSet& other) {
    for (std::size_t leaf = 0; leaf < slots_.size(); ++leaf) {
      if (slots_[leaf] == kNone) continue;
      const CellBits* const theirs = other.of(leaf);
      CellBits& own = bits_[slots_[leaf]];
      for (std::size_t word = 0; word < 8; ++word) own[word] &= theirs ? (*theirs)[word] : 0;
    }
  }

 private:
  // Adds cells along z of three leaves, the middle one from bit 8.
  void addRow(const LeafNeighbors& neighborhood, int x, int y, std::uint32_t row) {
    const auto first = static_cast<std::size_t>(((x >> 3) + 1) * 9 + ((y >> 3) + 1) * 3);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t bits = (row >> (8 * k)) & 0xff;
      if (bits == 0 || neighborhood[first + k] == LeafBlocks::kNone) continue;
      bitsOf(neighborhood[first + k])[static_cast<std::size_t>(x & 7)] |= bits << (8 * (y & 7));
    }
  }

  static constexpr std::uint32_t kNone = 0xffffffffu;

  CellBits& bitsOf(std::size_t leaf) {
    if (slots_[leaf] == kNone) {
      slots_[leaf] = static_cast<std::uint32_t>(bits_.size());
      bits_.push_back({});
    }
    return bits_[slots_[leaf]];
  }

  std::vector<std::uint32_t> slots_;  // [leaves] into bits_, or kNone
  std::vector<CellBits> bits_;
};

}  // namespace sherd
