// The voxels of each fragment as leaf masks.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// The voxels of a leaf, laid out as in LeafBlocks.
using LeafMask = std::array<std::uint64_t, 8>;

inline bool isEmpty(const LeafMask& mask) {
  std::uint64_t any = 0;
  for (const std::uint64_t word : mask) any |= word;
  return any == 0;
}

/// The voxels of one fragment.
struct FragmentMasks {
  std::vector<std::uint32_t> leaf;       ///< [n] leaf of the blocks, ascending
  std::vector<openvdb::Coord> origins;   ///< [n]
  std::vector<LeafMask> masks;           ///< [n]
  std::vector<LeafNeighbors> neighbors;  ///< [n] indices into these arrays
  std::size_t layer = 0;                 ///< see LeafBlocks::layers
};

/// Returns the inside voxels of each fragment: [fragmentCount], index i for fragment i + 1.
///   throws  Error(usage) an inside voxel has a label that is neither 0..fragmentCount nor kEroded
[[nodiscard]] std::vector<FragmentMasks> fragmentMasks(const Labels& labels);

}  // namespace sherd
