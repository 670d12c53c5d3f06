// The solid as flat arrays of 8x8x8 leaves: what kernels walk.
#pragma once

#include <sherd/grid_fwd.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// The leaves that hold inside voxels or outer-band voxels, as flat arrays.
///
/// A voxel's offset in its leaf is OpenVDB's: (x << 6) | (y << 3) | z, z fastest.  A leaf's mask is
/// eight 64-bit words, word x holding the slab of that x, bit (y << 3) | z:
///
///     mask[leaf*8 + x]   bit 63 ............ 8  7 ............ 0
///                        y=7 z=7..0   ...       y=0 z=7..z=0
///
/// The device reads the same arrays: layout in kernels/leaf_block.h.
struct LeafBlocks {
  static constexpr std::uint32_t kNone = 0xffffffffu;  ///< neighbour table: no leaf there

  std::vector<openvdb::Coord> origins;    ///< [n] lowest voxel of each leaf, ascending by x, y, z
  std::vector<std::uint64_t> inside;      ///< [n*8] voxels with distance < 0
  std::vector<std::uint64_t> outerBand;   ///< [n*8] active voxels with distance >= 0
  std::vector<std::uint32_t> neighbours;  ///< [n*6] leaf at -x +x -y +y -z +z, or kNone

  std::size_t count() const { return origins.size(); }

  std::uint64_t insideVoxels() const {
    std::uint64_t n = 0;
    for (const std::uint64_t word : inside) n += static_cast<std::uint64_t>(std::popcount(word));
    return n;
  }
};

/// Position of a voxel in its leaf from its offset 0..511.
inline openvdb::Coord coordFromOffset(std::uint32_t offset) {
  return {static_cast<int>(offset >> 6), static_cast<int>((offset >> 3) & 7),
          static_cast<int>(offset & 7)};
}

/// Index of the leaf that holds `voxel`, or LeafBlocks::kNone.
[[nodiscard]] std::uint32_t findLeaf(const LeafBlocks& blocks, const openvdb::Coord& voxel);

/// The neighbour table of leaves sorted as LeafBlocks wants them.
[[nodiscard]] std::vector<std::uint32_t> leafNeighbours(std::span<const openvdb::Coord> origins);

}  // namespace sherd
