// Voxels of leaf blocks as masks, and the steps between them.
#pragma once

#include <sherd/solid.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sherd {

/// [n*8] words as in LeafBlocks::inside.
using VoxelMask = std::vector<std::uint64_t>;

/// Returns what slab x of a leaf has beside the voxels of another, which is its neighbor `side`, in
/// the order of LeafBlocks::neighbors.
[[nodiscard]] inline std::uint64_t besideFace(const VoxelMask& mask, std::size_t neighbor,
                                              std::size_t side, std::size_t x) {
  constexpr std::uint64_t kLowZ = 0x0101010101010101;
  const std::uint64_t* const theirs = &mask[neighbor * 8];
  switch (side) {
    case 0:
      return x == 0 ? theirs[7] : 0;
    case 1:
      return x == 7 ? theirs[0] : 0;
    case 2:
      return theirs[x] >> 56;
    case 3:
      return theirs[x] << 56;
    case 4:
      return theirs[x] >> 7 & kLowZ;
    default:
      return (theirs[x] & kLowZ) << 7;
  }
}

/// Returns the voxels of slab x of a leaf, and those beside them in the leaf.
///   leaf  its eight words
[[nodiscard]] inline std::uint64_t withBeside(const std::uint64_t* leaf, std::size_t x) {
  constexpr std::uint64_t kHighZ = 0x8080808080808080, kLowZ = 0x0101010101010101;
  const std::uint64_t w = leaf[x];
  return w | w << 8 | w >> 8 | (w & ~kHighZ) << 1 | (w & ~kLowZ) >> 1 | (x > 0 ? leaf[x - 1] : 0) |
         (x < 7 ? leaf[x + 1] : 0);
}

/// Steps over faces that lead to all voxels within kHalfWidthVoxels.
inline constexpr int kBandSteps = 5;

/// Returns the voxels that at most `steps` steps over faces lead to.
///   within  the voxels that steps may lead to
[[nodiscard]] VoxelMask grownBySteps(const LeafBlocks& blocks, VoxelMask mask,
                                     const VoxelMask& within, int steps);

}  // namespace sherd
