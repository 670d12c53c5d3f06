// The solid that growth is measured on.
#pragma once

#include <sherd/labels.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "voxelize/leaves/leaf_blocks.h"

namespace bench {

using openvdb::Coord;

// A ball that fills a box of `size` voxels, as leaf blocks and as a dense array with a free border.
struct Ball {
  int size;
  std::uint64_t voxels = 0;
  std::shared_ptr<const sherd::LeafBlocks> blocks;
  std::vector<sherd::Seed> seeds;

  explicit Ball(int side) : size(side) {
    sherd::LeafBlocks made;
    for (int x = 0; x < size; x += 8) {
      for (int y = 0; y < size; y += 8) {
        for (int z = 0; z < size; z += 8) addLeaf(made, {x, y, z});
      }
    }
    made.exteriorBand.assign(made.inside.size(), 0);
    made.neighbors = sherd::leafNeighborTable(made.origins);
    voxels = made.insideVoxels();
    // Ten seeds by a fixed stride over the leaves.
    for (std::uint16_t id = 1; id <= 10; ++id) {
      std::size_t leaf = made.count() * id / 11;
      while (made.inside[leaf * 8 + 4] == 0) ++leaf;
      const int bit = std::countr_zero(made.inside[leaf * 8 + 4]);
      seeds.push_back({made.origins[leaf] + Coord(4, bit >> 3, bit & 7), id});
    }
    blocks = std::make_shared<const sherd::LeafBlocks>(std::move(made));
  }

  bool contains(int x, int y, int z) const {
    const std::int64_t cx = 2 * x + 1 - size, cy = 2 * y + 1 - size, cz = 2 * z + 1 - size;
    return cx * cx + cy * cy + cz * cz <= static_cast<std::int64_t>(size) * size;
  }

  /// The box as a dense array of labels within a border of one voxel: 0 inside, 0xffff outside.
  template <class T>
  std::vector<T> dense() const {
    const std::size_t side = static_cast<std::size_t>(size) + 2;
    std::vector<T> array(side * side * side, T{0xffff});
    for (int x = 0; x < size; ++x) {
      for (int y = 0; y < size; ++y) {
        for (int z = 0; z < size; ++z) {
          if (contains(x, y, z)) array[denseAt({x, y, z})] = 0;
        }
      }
    }
    return array;
  }

  std::size_t denseAt(const Coord& v) const {
    const std::size_t side = static_cast<std::size_t>(size) + 2;
    return (static_cast<std::size_t>(v.x() + 1) * side + static_cast<std::size_t>(v.y() + 1)) *
               side +
           static_cast<std::size_t>(v.z() + 1);
  }

  /// From a voxel of that array to the next along each axis.
  std::array<std::uint32_t, 3> denseSteps() const {
    const auto side = static_cast<std::uint32_t>(size) + 2;
    return {side * side, side, 1};
  }

  void addLeaf(sherd::LeafBlocks& made, const Coord& origin) const {
    std::uint64_t words[8] = {}, any = 0;
    for (int v = 0; v < 512; ++v) {
      if (contains(origin.x() + (v >> 6), origin.y() + ((v >> 3) & 7), origin.z() + (v & 7))) {
        words[v >> 6] |= std::uint64_t{1} << (v & 63);
      }
    }
    for (const std::uint64_t word : words) any |= word;
    if (!any) return;
    made.origins.push_back(origin);
    made.inside.insert(made.inside.end(), words, words + 8);
  }
};

inline const Ball& ball(int size) {
  static std::map<int, std::unique_ptr<Ball>> made;
  std::unique_ptr<Ball>& entry = made[size];
  if (!entry) entry = std::make_unique<Ball>(size);
  return *entry;
}

}  // namespace bench
