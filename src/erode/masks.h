// The voxels of each fragment, as masks of the leaves it lies in.
#pragma once

#include <sherd/labels.h>
#include <sherd/leaf_blocks.h>

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// The voxels of a leaf, laid out as in LeafBlocks.
using LeafMask = std::array<std::uint64_t, 8>;

inline bool isEmpty(const LeafMask& mask) {
  std::uint64_t any = 0;
  for (const std::uint64_t word : mask) any |= word;
  return any == 0;
}

inline std::uint64_t voxelsIn(const LeafMask& mask) {
  std::uint64_t n = 0;
  for (const std::uint64_t word : mask) n += static_cast<std::uint64_t>(std::popcount(word));
  return n;
}

/// The 27 leaves round a leaf by x, y, z, itself at 13; LeafBlocks::kNone where there is none.
using Round = std::array<std::uint32_t, 27>;

/// The leaves round each of leaves sorted as LeafBlocks wants them.
[[nodiscard]] std::vector<Round> leavesRound(std::span<const openvdb::Coord> origins);

/// One fragment: the leaves that hold voxels of it.
struct FragmentMasks {
  std::vector<std::uint32_t> leaf;      ///< [n] leaf of the blocks, ascending
  std::vector<openvdb::Coord> origins;  ///< [n]
  std::vector<LeafMask> masks;          ///< [n]
  std::vector<Round> round;             ///< [n] within the fragment
};

/// The inside voxels of each fragment: [fragments], of fragment i + 1.
///   throws  Error(usage) an inside voxel has a label that is neither 0..fragments nor worn
[[nodiscard]] std::vector<FragmentMasks> fragmentMasks(const LeafBlocks& blocks,
                                                       const Labels& labels, int fragments);

}  // namespace sherd
