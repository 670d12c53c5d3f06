// Leaves of a solid by position, and their neighborhoods.
#pragma once

#include <sherd/solid.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// Returns the index of the leaf that holds `voxel`, or LeafBlocks::kNone.
[[nodiscard]] std::uint32_t findLeaf(const LeafBlocks& blocks, const openvdb::Coord& voxel);

inline constexpr std::size_t kNoVoxel = ~std::size_t{0};

/// Returns the voxel in which a point in index space lies.
[[nodiscard]] inline openvdb::Coord nearestVoxel(const glm::dvec3& point) {
  return {static_cast<int>(std::floor(point.x + 0.5)), static_cast<int>(std::floor(point.y + 0.5)),
          static_cast<int>(std::floor(point.z + 0.5))};
}

/// Returns the index of a voxel, or kNoVoxel where there is no leaf.
[[nodiscard]] std::size_t voxelIndexAt(const LeafBlocks& blocks, const openvdb::Coord& voxel);

/// Returns the voxel behind one in positive x, y or z, or kNoVoxel.
[[nodiscard]] std::size_t voxelBehind(const LeafBlocks& blocks, std::size_t voxel,
                                      std::size_t axis);

/// Returns the voxel beside one, on a side in the order of LeafBlocks::neighbors, or kNoVoxel.
[[nodiscard]] std::size_t voxelBeside(const LeafBlocks& blocks, std::size_t voxel,
                                      std::size_t side);

/// Returns a word of the inside voxels of a layer.
[[nodiscard]] std::uint64_t insideOfLayer(const LeafBlocks& blocks, std::size_t layer,
                                          std::size_t word);

/// Returns LeafBlocks::layers of blocks some of whose voxels are those of others.
[[nodiscard]] std::vector<std::vector<std::uint64_t>> layersOf(const LeafBlocks& blocks,
                                                               const LeafBlocks& others);

/// Returns the tight box of the inside voxels; empty() if there are none.
[[nodiscard]] VoxelBox insideBox(const LeafBlocks& blocks);

/// Returns the longest side of that box, at least 1; `given` if that is not 0.
[[nodiscard]] double longestSideOr(double given, const LeafBlocks& blocks);

/// Returns LeafBlocks::neighbors for leaves in the order of LeafBlocks::origins.
[[nodiscard]] std::vector<std::uint32_t> leafNeighborTable(std::span<const openvdb::Coord> origins);

/// A leaf and its 26 neighbors, x slowest, the leaf itself at 13; LeafBlocks::kNone: no leaf.
using LeafNeighbors = std::array<std::uint32_t, 27>;

/// Returns the neighborhoods of leaves in the order of LeafBlocks::origins.
[[nodiscard]] std::vector<LeafNeighbors> leafNeighbors(std::span<const openvdb::Coord> origins);

}  // namespace sherd
