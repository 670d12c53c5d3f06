// Voxels of leaf masks by number, key and place.
#pragma once

#include <sherd/seeds.h>

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sherd {

/// A voxel by its place in leaf blocks.
using VoxelKey = std::uint64_t;

/// Inside voxels with a face neighbour that is not inside: [leaf*8] words like LeafBlocks::inside.
[[nodiscard]] std::vector<std::uint64_t> surfaceMask(const LeafBlocks& blocks);

/// The voxels of a mask over leaf blocks, numbered 0..total()-1 in leaf order.  It keeps references
/// to what it is made from.
class VoxelIndex {
 public:
  VoxelIndex(const LeafBlocks& blocks, std::span<const std::uint64_t> mask);

  std::uint64_t total() const { return total_; }

  /// The voxel with this number.
  VoxelKey at(std::uint64_t number) const;

  /// The voxel at a place, where the mask holds it.
  std::optional<VoxelKey> find(const openvdb::Coord& voxel) const;

  openvdb::Coord place(VoxelKey key) const { return blocks_.voxelAt(key); }

  /// The nearest voxel to a point in index space; ties to the lowest x, then y, then z.
  openvdb::Coord nearest(const glm::dvec3& point) const;

  /// Voxels of the mask in each part.
  std::vector<std::uint64_t> countInParts(const Parts& parts) const;

  /// The voxels with these numbers among the mask's voxels of their parts.
  std::vector<VoxelKey> atInParts(const Parts& parts, std::vector<std::uint64_t> number) const;

  /// Call visit(key) for each voxel in leaf order.
  template <class Visit>
  void forEach(const Visit& visit) const {
    for (std::size_t word = 0; word < mask_.size(); ++word) {
      for (std::uint64_t bits = mask_[word]; bits; bits &= bits - 1) {
        visit(word * 64 + static_cast<std::uint64_t>(std::countr_zero(bits)));
      }
    }
  }

 private:
  const LeafBlocks& blocks_;
  std::span<const std::uint64_t> mask_;
  std::vector<std::uint64_t> before_;  // [word] voxels in earlier words
  std::uint64_t total_ = 0;
};

}  // namespace sherd
