// Voxels of leaf masks by number, key and coordinates.
#pragma once

#include <sherd/seeds.h>

#include <bit>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace sherd {

/// The index of a voxel in leaf blocks: leaf * 512 + offset.
using VoxelKey = std::uint64_t;

/// Returns the inside voxels with a face neighbor that is not inside: [leaf*8] words like
/// LeafBlocks::inside.
[[nodiscard]] std::vector<std::uint64_t> surfaceMask(const LeafBlocks& blocks);

/// Returns a voxel's center in index space.
[[nodiscard]] inline glm::dvec3 centerOf(const openvdb::Coord& voxel) {
  return {voxel.x(), voxel.y(), voxel.z()};
}

/// The voxels of a mask over leaf blocks, numbered 0..total()-1 in leaf order.  Keeps references to
/// the blocks and the mask.
class VoxelIndex {
 public:
  VoxelIndex(const LeafBlocks& blocks, std::span<const std::uint64_t> mask);

  std::uint64_t total() const { return total_; }

  /// Returns the voxel with this number.
  VoxelKey at(std::uint64_t number) const;

  /// Returns the voxel at these coordinates if the mask contains it.
  std::optional<VoxelKey> find(const openvdb::Coord& voxel) const;

  openvdb::Coord voxelAt(VoxelKey key) const { return blocks_.voxelAt(key); }

  /// Returns the nearest voxel to a point in index space; ties go to the lowest x, then y, then z.
  openvdb::Coord nearest(const glm::dvec3& point) const;

  /// Returns the nearest voxel within `reach` of a point in index space, of those that `accepts`;
  /// ties as in nearest.
  std::optional<VoxelKey> nearestWithin(
      const glm::dvec3& point, double reach,
      const std::function<bool(VoxelKey)>& accepts = [](VoxelKey) { return true; }) const;

  /// Returns the number of the mask's voxels in each component.
  std::vector<std::uint64_t> countInComponents(const VoxelComponents& components) const;

  /// Returns for each component the voxel with this number among the mask's voxels in it.
  std::vector<VoxelKey> atInComponents(const VoxelComponents& components,
                                       std::vector<std::uint64_t> number) const;

  /// Calls visit(key) for each voxel in leaf order.
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
