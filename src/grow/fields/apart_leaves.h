// Leaves of voxels of several layers, taken apart: growth runs over one leaf for each layer.
#pragma once

#include <sherd/solid.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// Leaf blocks, layer after layer, each in the order of origins: leaves of different layers have
/// the same origin, and are not neighbors.  So whatever follows neighbors stays within a layer.
struct ApartLeaves {
  /// Without LeafBlocks::layers.  Leaves of the exterior band alone are left out.
  std::shared_ptr<const LeafBlocks> blocks{};
  std::vector<std::uint32_t> firstOfLayer{};  ///< [layers + 1] leaves; empty: one layer
  std::vector<std::uint32_t> source{};        ///< [leaves] of the blocks that were taken apart

  /// Returns the values of the leaves, of those of the blocks that were taken apart.
  ///   count  values of a leaf
  template <class T>
  [[nodiscard]] std::vector<T> gathered(std::span<const T> values, std::size_t count = 1) const {
    std::vector<T> out;
    out.reserve(source.size() * count);
    for (const std::size_t leaf : source) {
      const auto from = values.subspan(leaf * count, count);
      out.insert(out.end(), from.begin(), from.end());
    }
    return out;
  }

  /// Returns values of voxels of the blocks that were taken apart, 0 outside.
  ///   values  [leaves * 512]
  ///   leaves  of those blocks
  template <class T>
  [[nodiscard]] std::vector<T> joined(std::span<const T> values, std::size_t leaves) const {
    std::vector<T> out(leaves * 512, T{0});
    blocks->forEachInside([&](std::size_t voxel) {
      out[std::size_t{source[voxel / 512]} * 512 + voxel % 512] = values[voxel];
    });
    return out;
  }
};

/// Takes leaves apart, of any number of layers.
[[nodiscard]] ApartLeaves apartLeaves(const LeafBlocks& blocks);

/// Returns some of the leaves, their inside alone, with `source` by the leaves given.
///   leaves  ascending
[[nodiscard]] ApartLeaves insideOf(const LeafBlocks& blocks,
                                   std::span<const std::uint32_t> firstOfLayer,
                                   std::span<const std::uint32_t> leaves);

/// Returns the neighborhoods of leaves of several layers.
///   firstOfLayer  as above; empty: one layer
[[nodiscard]] std::vector<LeafNeighbors> leafNeighbors(std::span<const openvdb::Coord> origins,
                                                       std::span<const std::uint32_t> firstOfLayer);

/// Returns the leaf whose origin is `offset` away from another's, of its layer, or
/// LeafBlocks::kNone.
[[nodiscard]] std::uint32_t findBeside(const LeafBlocks& blocks,
                                       std::span<const std::uint32_t> firstOfLayer,
                                       std::size_t leaf, const openvdb::Coord& offset);

/// Returns the index of an inside voxel, or kNoVoxel.
[[nodiscard]] std::size_t findInside(const LeafBlocks& blocks,
                                     std::span<const std::uint32_t> firstOfLayer,
                                     const openvdb::Coord& voxel);

}  // namespace sherd
