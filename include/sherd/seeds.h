// The parts of a solid, and the seeds that fragments grow from.
#pragma once

#include <sherd/device.h>
#include <sherd/leaf_blocks.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sherd {

/// The largest fragment id: `labels.rle` stores id + 1 in 16 bits.
inline constexpr int kMaxFragments = 65534;

/// The 6-connected parts of the inside, numbered 0..count()-1 by their first voxel in leaf order.
struct Parts {
  std::vector<std::uint32_t> firstNode;   ///< [leaf] number of the leaf's first node
  std::vector<std::uint8_t> localNode;    ///< [leaf*512] node of an inside voxel within its leaf
  std::vector<std::uint32_t> partOfNode;  ///< [nodes]
  std::vector<std::uint64_t> voxels;      ///< [count()] inside voxels of each part

  std::size_t count() const { return voxels.size(); }
  std::uint32_t at(std::size_t leaf, std::uint32_t offset) const {
    return partOfNode[firstNode[leaf] + localNode[leaf * 512 + offset]];
  }
};

/// Find the 6-connected parts on the device: a flood inside each leaf, then a union of the nodes
/// that touch across leaf faces.  The result does not depend on the schedule.
///   throws  Error(device)
///   source  Jaiganesh and Burtscher, ECL-CC, HPDC 2018 (the lock-free union)
[[nodiscard]] Parts findParts(const LeafBlocks& blocks, Device& device);

/// One voxel that a fragment grows from.
struct Seed {
  openvdb::Coord voxel;
  std::uint16_t fragment = 0;  ///< 1..kMaxFragments
};

struct SeedOptions {
  int pieces = 8;          ///< fragments wanted, 1..kMaxFragments
  std::uint64_t seed = 0;  ///< every random choice is a hash of this, a stage and an item
};

/// Place one seed in each part, the rest uniformly over all inside voxels, on distinct voxels.  Ids
/// are a random permutation of 1..n.  With fewer pieces than parts, one seed per part.
///   return  [max(pieces, parts)] ascending by fragment id
///   throws  Error(usage) more pieces than inside voxels, or than kMaxFragments
[[nodiscard]] std::vector<Seed> placeSeeds(const LeafBlocks& blocks, const Parts& parts,
                                           const SeedOptions& options);

}  // namespace sherd
