// Edges near cells, and slices of labels, against one voxel at a time.
#include "interface/cells/cell_set.h"

#include <gtest/gtest.h>
#include <sherd/labels.h>
#include <sherd/solid.h>

#include <map>
#include <memory>
#include <random>
#include <vector>

#include "grow/fields/label_slices.h"

namespace sherd {
namespace {

// 3*3*3 leaves, so that the middle one has all neighbors.
LeafBlocks cubeOfLeaves() {
  LeafBlocks blocks;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 3; ++y) {
      for (int z = 0; z < 3; ++z) blocks.origins.push_back(openvdb::Coord(8 * x, 8 * y, 8 * z));
    }
  }
  return blocks;
}

TEST(EdgesAround, AreThoseWithACellOfTheSetAroundThem) {
  std::mt19937 random(7);
  const LeafBlocks blocks = cubeOfLeaves();
  const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(blocks.origins);
  for (int round = 0; round < 40; ++round) {
    std::vector<CellBits> cells(27, CellBits{});
    std::vector<bool> has(27);
    for (std::size_t leaf = 0; leaf < 27; ++leaf) {
      has[leaf] = random() % 3 != 0;
      for (int k = 0; k < round; ++k) {
        const std::size_t offset = random() % 512;
        cells[leaf][offset / 64] |= std::uint64_t{1} << (offset % 64);
      }
    }
    const auto isIn = [&](const openvdb::Coord& at) {
      if (at.x() < 0 || at.y() < 0 || at.z() < 0) return false;
      const auto leaf = static_cast<std::size_t>(at.x() / 8 * 9 + at.y() / 8 * 3 + at.z() / 8);
      const auto offset = static_cast<std::size_t>(at.x() % 8 * 64 + at.y() % 8 * 8 + at.z() % 8);
      return has[leaf] && sherd::has(cells[leaf], offset);
    };
    for (const std::size_t leaf : {std::size_t{0}, std::size_t{13}, std::size_t{26}}) {
      const LeafEdges edges = edgesAround(
          neighborhoods[leaf], [&](std::size_t of) { return has[of] ? &cells[of] : nullptr; });
      for (std::size_t offset = 0; offset < 512; ++offset) {
        const openvdb::Coord at =
            blocks.origins[leaf] + openvdb::Coord(static_cast<int>(offset / 64),
                                                  static_cast<int>(offset / 8 % 8),
                                                  static_cast<int>(offset % 8));
        for (int axis = 0; axis < 3; ++axis) {
          bool isNear = false;
          for (int k = 0; k < 4; ++k) {
            openvdb::Coord around = at;
            around[(axis + 1) % 3] -= k & 1;
            around[(axis + 2) % 3] -= k >> 1;
            isNear = isNear || isIn(around);
          }
          ASSERT_EQ(sherd::has(edges[static_cast<std::size_t>(axis)], offset), isNear)
              << "leaf " << leaf << " offset " << offset << " axis " << axis;
        }
      }
    }
  }
}

TEST(LabelSlices, VisitEachInsideVoxelOnce) {
  std::mt19937 random(3);
  auto blocks = std::make_shared<LeafBlocks>(cubeOfLeaves());
  blocks->inside.resize(27 * 8);
  for (std::uint64_t& word : blocks->inside) {
    word = random() % 4 == 0 ? 0 : (std::uint64_t{random()} << 32 | random());
  }
  Labels labels{.blocks = blocks, .fragmentCount = 3};
  labels.fragment.resize(27 * 512);
  std::uint16_t label = 1;
  for (std::uint16_t& own :
       labels.fragment) {  // in runs, so that slices and rows of one label are among them
    if (random() % 60 == 0) label = static_cast<std::uint16_t>(random() % 4);
    own = label;
  }
  std::map<std::size_t, std::uint16_t> seen, expected;
  blocks->forEachInside([&](std::size_t voxel) { expected[voxel] = labels.fragment[voxel]; });
  for (std::size_t leaf = 0; leaf < 27; ++leaf) {
    forEachLabelSlice(labels, leaf, [&](std::uint16_t of, std::size_t x, std::uint64_t bits) {
      for (std::size_t i = 0; i < 64; ++i) {
        if (((bits >> i) & 1) == 0) continue;
        EXPECT_TRUE(seen.emplace(leaf * 512 + x * 64 + i, of).second);
      }
    });
  }
  EXPECT_EQ(seen, expected);
  const std::vector<std::uint64_t> counts = countVoxels(labels);
  for (std::uint16_t of = 0; of < 4; ++of) {
    std::size_t count = 0;
    for (const auto& [voxel, own] : expected) count += own == of ? 1 : 0;
    EXPECT_EQ(counts[of], count);
  }
}

}  // namespace
}  // namespace sherd
