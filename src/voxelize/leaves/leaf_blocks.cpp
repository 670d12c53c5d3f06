// Lookup of leaves, and neighbor tables of leaf blocks.
#include "voxelize/leaves/leaf_blocks.h"

#include <sherd/solid.h>

#include <algorithm>
#include <bit>

namespace sherd {

std::uint32_t findLeaf(const LeafBlocks& blocks, const openvdb::Coord& voxel) {
  const openvdb::Coord origin = voxel & ~7;
  const auto at = std::lower_bound(blocks.origins.begin(), blocks.origins.end(), origin);
  if (at == blocks.origins.end() || *at != origin) return LeafBlocks::kNone;
  return static_cast<std::uint32_t>(at - blocks.origins.begin());
}

std::size_t voxelIndexAt(const LeafBlocks& blocks, const openvdb::Coord& voxel) {
  const std::uint32_t leaf = findLeaf(blocks, voxel);
  return leaf == LeafBlocks::kNone ? kNoVoxel : std::size_t{leaf} * 512 + offsetFromCoord(voxel);
}

std::size_t voxelBehind(const LeafBlocks& blocks, std::size_t voxel, std::size_t axis) {
  static constexpr std::size_t kStep[] = {64, 8, 1};
  const std::size_t step = kStep[axis];
  if (voxel / step % 8 != 7) return voxel + step;
  const std::uint32_t leaf = blocks.neighbors[voxel / 512 * 6 + 2 * axis + 1];
  return leaf == LeafBlocks::kNone ? kNoVoxel : std::size_t{leaf} * 512 + voxel % 512 - 7 * step;
}

std::size_t voxelBeside(const LeafBlocks& blocks, std::size_t voxel, std::size_t side) {
  static constexpr std::size_t kStep[] = {64, 8, 1};
  if (side % 2 == 1) return voxelBehind(blocks, voxel, side / 2);
  const std::size_t step = kStep[side / 2];
  if (voxel / step % 8 != 0) return voxel - step;
  const std::uint32_t leaf = blocks.neighbors[voxel / 512 * 6 + side];
  return leaf == LeafBlocks::kNone ? kNoVoxel : std::size_t{leaf} * 512 + voxel % 512 + 7 * step;
}

std::uint64_t insideOfLayer(const LeafBlocks& blocks, std::size_t layer, std::size_t word) {
  if (layer > 0) return blocks.layers[layer - 1][word];
  std::uint64_t own = blocks.inside[word];
  for (const std::vector<std::uint64_t>& other : blocks.layers) own &= ~other[word];
  return own;
}

std::vector<std::vector<std::uint64_t>> layersOf(const LeafBlocks& blocks,
                                                 const LeafBlocks& others) {
  std::vector<std::vector<std::uint64_t>> layers(
      others.layers.size(), std::vector<std::uint64_t>(blocks.inside.size(), 0));
  for (std::size_t leaf = 0; !layers.empty() && leaf < blocks.count(); ++leaf) {
    const std::uint32_t from = findLeaf(others, blocks.origins[leaf]);
    if (from == LeafBlocks::kNone) continue;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      for (std::size_t x = 0; x < 8; ++x) {
        layers[i][leaf * 8 + x] =
            others.layers[i][std::size_t{from} * 8 + x] & blocks.inside[leaf * 8 + x];
      }
    }
  }
  return layers;
}

double longestSideOr(double given, const LeafBlocks& blocks) {
  return given > 0.0 ? given : std::max(insideBox(blocks).longestSide(), 1);
}

VoxelBox insideBox(const LeafBlocks& blocks) {
  VoxelBox box{openvdb::Coord::max(), openvdb::Coord::min()};
  for (std::size_t word = 0; word < blocks.inside.size(); ++word) {
    const std::uint64_t bits = blocks.inside[word];
    if (!bits) continue;
    std::uint64_t zs = bits;  // any y, folded into the low byte
    for (int shift = 32; shift >= 8; shift /= 2) zs |= zs >> shift;
    const auto z = static_cast<unsigned>(zs & 0xff);
    const openvdb::Coord origin =
        blocks.origins[word / 8] + openvdb::Coord(static_cast<int>(word % 8), 0, 0);
    box.min.minComponent(origin +
                         openvdb::Coord(0, std::countr_zero(bits) / 8, std::countr_zero(z)));
    box.max.maxComponent(
        origin + openvdb::Coord(0, 7 - std::countl_zero(bits) / 8, 31 - std::countl_zero(z)));
  }
  return box.max.x() < box.min.x() ? VoxelBox{} : box;
}

std::vector<std::uint32_t> leafNeighborTable(std::span<const openvdb::Coord> origins) {
  // A shifted list is still sorted, so one cursor per axis finds all neighbors in a single pass.
  std::vector<std::uint32_t> table(origins.size() * 6, LeafBlocks::kNone);
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Coord offset(0, 0, 0);
    offset[axis] = 8;
    std::size_t cursor = 0;
    for (std::size_t leaf = 0; leaf < origins.size(); ++leaf) {
      const openvdb::Coord beyond = origins[leaf] + offset;
      while (cursor < origins.size() && origins[cursor] < beyond) ++cursor;
      if (cursor < origins.size() && origins[cursor] == beyond) {
        table[leaf * 6 + static_cast<std::size_t>(2 * axis + 1)] =
            static_cast<std::uint32_t>(cursor);
        table[cursor * 6 + static_cast<std::size_t>(2 * axis)] = static_cast<std::uint32_t>(leaf);
      }
    }
  }
  return table;
}

std::vector<LeafNeighbors> leafNeighbors(std::span<const openvdb::Coord> origins) {
  // A shifted list is still sorted, so one cursor per direction finds all neighbors in a single
  // pass.  13 of the directions ascend; the other 13 are their opposites.
  LeafNeighbors none;
  none.fill(LeafBlocks::kNone);
  std::vector<LeafNeighbors> neighbors(origins.size(), none);
  for (std::size_t leaf = 0; leaf < origins.size(); ++leaf) {
    neighbors[leaf][13] = static_cast<std::uint32_t>(leaf);
  }
  for (std::size_t k = 14; k < 27; ++k) {
    const auto at = static_cast<int>(k);
    const openvdb::Coord offset(8 * (at / 9 - 1), 8 * (at / 3 % 3 - 1), 8 * (at % 3 - 1));
    std::size_t cursor = 0;
    for (std::size_t leaf = 0; leaf < origins.size(); ++leaf) {
      const openvdb::Coord beyond = origins[leaf] + offset;
      while (cursor < origins.size() && origins[cursor] < beyond) ++cursor;
      if (cursor == origins.size()) break;
      if (origins[cursor] != beyond) continue;
      neighbors[leaf][k] = static_cast<std::uint32_t>(cursor);
      neighbors[cursor][26 - k] = static_cast<std::uint32_t>(leaf);
    }
  }
  return neighbors;
}

}  // namespace sherd
