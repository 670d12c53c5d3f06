// Seeds that walls would give one middle.
#include "seed/draw/distinct_middles.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <tuple>
#include <vector>

namespace sherd {
namespace {

// One leaf: a wall of two voxels across z, whose middle lies between them, 64 columns.
struct TwoSided {
  std::shared_ptr<LeafBlocks> blocks = std::make_shared<LeafBlocks>();
  std::shared_ptr<const WallMiddles> middles;

  TwoSided() {
    blocks->origins.emplace_back(0, 0, 0);
    blocks->inside.assign(8, 0x1818181818181818u);  // z of 3 and 4
    std::vector<std::int16_t> ways(512 * 3, 0);
    for (std::size_t v = 0; v < 512; ++v) ways[3 * v + 2] = v % 8 == 3 ? 32 : v % 8 == 4 ? -32 : 0;
    middles = std::make_shared<const WallMiddles>(blocks, ways);
  }

  std::set<std::tuple<int, int>> columnsOf(const std::vector<Seed>& seeds) const {
    std::set<std::tuple<int, int>> columns;
    for (const Seed& seed : seeds) columns.emplace(seed.voxel.x(), seed.voxel.y());
    return columns;
  }
};

TEST(DistinctMiddles, TheLaterSeedMovesToAnotherColumn) {
  const TwoSided wall;
  const std::vector<Seed> seeds{{{2, 2, 3}, 1}, {{2, 2, 4}, 2, {5, 5, -20}}, {{5, 5, 3}, 3}};
  const std::vector<Seed> moved = withDistinctMiddles(seeds, *wall.blocks, *wall.middles);
  EXPECT_EQ(moved[0], seeds[0]);
  EXPECT_EQ(moved[2], seeds[2]);
  EXPECT_EQ(moved[1].fragment, 2);
  EXPECT_EQ(moved[1].shift, glm::ivec3(0));
  EXPECT_EQ(wall.columnsOf(moved).size(), 3u);
  EXPECT_LE(std::abs(moved[1].voxel.x() - 2) + std::abs(moved[1].voxel.y() - 2), 1);
}

TEST(DistinctMiddles, SeedsOfOneFragmentStay) {
  const TwoSided wall;
  const std::vector<Seed> seeds{{{2, 2, 3}, 1}, {{2, 2, 4}, 1}};
  EXPECT_EQ(withDistinctMiddles(seeds, *wall.blocks, *wall.middles), seeds);
}

TEST(DistinctMiddles, ManyFindColumnsOfTheirOwnUntilThereIsNone) {
  const TwoSided wall;
  std::vector<Seed> seeds;
  for (int i = 0; i < 64; ++i) {  // all 32 columns of y < 4, twice
    seeds.push_back({{i / 8, i / 2 % 4, 3 + i % 2}, static_cast<std::uint16_t>(i + 1)});
  }
  EXPECT_EQ(wall.columnsOf(withDistinctMiddles(seeds, *wall.blocks, *wall.middles)).size(), 64u);
  for (int i = 0; i < 64; ++i) {  // and those of y >= 4
    seeds.push_back({{i / 8, 4 + i / 2 % 4, 3 + i % 2}, static_cast<std::uint16_t>(i + 65)});
  }
  const std::vector<Seed> full = withDistinctMiddles(seeds, *wall.blocks, *wall.middles);
  EXPECT_EQ(full.size(), 128u);
  std::set<std::tuple<int, int, int>> voxels;
  for (const Seed& seed : full) {
    voxels.emplace(seed.voxel.x(), seed.voxel.y(), seed.voxel.z());
  }
  EXPECT_EQ(voxels.size(), 128u) << "seeds share a voxel";
}

}  // namespace
}  // namespace sherd
