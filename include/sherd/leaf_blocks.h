// The solid as flat arrays of 8x8x8 leaves, the layout that kernels read.
#pragma once

#include <sherd/coords.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// Position of a voxel in its leaf from its offset 0..511.
inline openvdb::Coord coordFromOffset(std::uint32_t offset) {
  return {static_cast<int>(offset >> 6), static_cast<int>((offset >> 3) & 7),
          static_cast<int>(offset & 7)};
}

/// Offset 0..511 of a voxel in its leaf, from its index-space position.
inline std::uint32_t offsetFromCoord(const openvdb::Coord& voxel) {
  return static_cast<std::uint32_t>(((voxel.x() & 7) << 6) | ((voxel.y() & 7) << 3) |
                                    (voxel.z() & 7));
}

/// The leaves that hold inside voxels or exterior-band voxels, as flat arrays.
///
/// A voxel's offset in its leaf is OpenVDB's: (x << 6) | (y << 3) | z, z fastest.  A leaf's mask is
/// eight 64-bit words, word x holding the slab of that x, bit (y << 3) | z:
///
///     mask[leaf*8 + x]   bit 63 ............ 8  7 ............ 0
///                        y=7 z=7..0   ...       y=0 z=7..z=0
///
/// A voxel index is leaf * 512 + offset, ascending in leaf order.
///
/// The device reads the same arrays; kernels/leaf_block.h has the layout.
struct LeafBlocks {
  static constexpr std::uint32_t kNone = 0xffffffffu;  ///< in `neighbors`: no leaf

  std::vector<openvdb::Coord> origins;      ///< [n] lowest voxel of each leaf, ascending by x, y, z
  std::vector<std::uint64_t> inside;        ///< [n*8] voxels with distance < 0
  std::vector<std::uint64_t> exteriorBand;  ///< [n*8] active voxels with distance >= 0
  std::vector<std::uint32_t> neighbors;     ///< [n*6] leaf at -x +x -y +y -z +z, or kNone

  std::size_t count() const { return origins.size(); }

  std::uint64_t insideVoxels() const {
    std::uint64_t n = 0;
    for (const std::uint64_t word : inside) n += static_cast<std::uint64_t>(std::popcount(word));
    return n;
  }

  bool isInside(std::size_t voxel) const { return (inside[voxel / 64] >> (voxel % 64)) & 1; }

  /// Position of a voxel in the grid, from its index.
  openvdb::Coord voxelAt(std::size_t voxel) const {
    return origins[voxel / 512] + coordFromOffset(static_cast<std::uint32_t>(voxel % 512));
  }

  /// Calls visit(voxel) with the index of each inside voxel, ascending.
  template <class Visit>
  void forEachInside(const Visit& visit) const {
    for (std::size_t word = 0; word < inside.size(); ++word) {
      for (std::uint64_t bits = inside[word]; bits; bits &= bits - 1) {
        visit(word * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
      }
    }
  }
};

/// Returns the index of the leaf that holds `voxel`, or LeafBlocks::kNone.
[[nodiscard]] std::uint32_t findLeaf(const LeafBlocks& blocks, const openvdb::Coord& voxel);

/// Returns the tight box of the inside voxels; empty() if there are none.
[[nodiscard]] VoxelBox insideBox(const LeafBlocks& blocks);

/// Returns LeafBlocks::neighbors for leaves in the order of LeafBlocks::origins.
[[nodiscard]] std::vector<std::uint32_t> leafNeighborTable(std::span<const openvdb::Coord> origins);

/// A leaf and its 26 neighbors, x slowest, the leaf itself at 13; LeafBlocks::kNone: no leaf.
using LeafNeighbors = std::array<std::uint32_t, 27>;

/// Returns the neighborhoods of leaves in the order of LeafBlocks::origins.
[[nodiscard]] std::vector<LeafNeighbors> leafNeighbors(std::span<const openvdb::Coord> origins);

}  // namespace sherd
