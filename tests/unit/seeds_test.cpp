// Seed placement.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <set>

#include "kernels/device_fixture.h"
#include "kernels/voxel_shapes.h"

namespace sherd {
namespace {

using Seeds = DeviceTest;

TEST_F(Seeds, LieOnDistinctVoxelsWithIdsWithoutGaps) {
  const voxel_shapes::VoxelSolid solid = voxel_shapes::ball(6);
  const LeafBlocks blocks = voxel_shapes::blocksOf(solid);
  const Parts parts = findParts(blocks, device());
  const int all = static_cast<int>(solid.inside.size());
  for (const int pieces : {1, 7, all / 2, all}) {
    const std::vector<Seed> seeds = placeSeeds(blocks, parts, {.pieces = pieces, .seed = 4});
    ASSERT_EQ(seeds.size(), static_cast<std::size_t>(pieces));
    std::set<openvdb::Coord> voxels;
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      EXPECT_EQ(seeds[i].fragment, i + 1);
      EXPECT_TRUE(solid.inside.count(seeds[i].voxel));
      voxels.insert(seeds[i].voxel);
    }
    EXPECT_EQ(voxels.size(), seeds.size());
  }
  EXPECT_THROW((void)placeSeeds(blocks, parts, {.pieces = all + 1}), Error);
}

TEST_F(Seeds, EveryPartHasOne) {
  const voxel_shapes::VoxelSolid solid = voxel_shapes::sparseRandom(10, 30, 6);
  const LeafBlocks blocks = voxel_shapes::blocksOf(solid);
  const Parts parts = findParts(blocks, device());
  ASSERT_GT(parts.count(), 100u);
  std::set<std::uint32_t> seeded;
  for (const Seed& seed : placeSeeds(blocks, parts, {.pieces = 3, .seed = 1})) {
    const std::size_t place = voxel_shapes::placeOf(blocks, seed.voxel);
    seeded.insert(parts.at(place / 512, static_cast<std::uint32_t>(place % 512)));
  }
  EXPECT_EQ(seeded.size(), parts.count());
}

TEST_F(Seeds, AreUniformOverTheVoxels) {
  // 8 octants of a cube, 40,000 draws: a chi-square of 7 degrees of freedom passes 24.3 once in
  // 1,000.
  const voxel_shapes::VoxelSolid solid = voxel_shapes::solidWhere(
      "cube", 8, [](const openvdb::Coord& v) { return v.x() < 8 && v.y() < 8 && v.z() < 8; });
  const LeafBlocks blocks = voxel_shapes::blocksOf(solid);
  const Parts parts = findParts(blocks, device());
  std::array<double, 8> hits{};
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    for (const Seed& s : placeSeeds(blocks, parts, {.pieces = 200, .seed = seed})) {
      ++hits[static_cast<std::size_t>((s.voxel.x() < 0) * 4 + (s.voxel.y() < 0) * 2 +
                                      (s.voxel.z() < 0))];
    }
  }
  double chi2 = 0.0;
  for (const double n : hits) chi2 += (n - 5000.0) * (n - 5000.0) / 5000.0;
  EXPECT_LT(chi2, 24.3);
}

TEST_F(Seeds, IdsDoNotFollowThePlace) {
  // With ids in order of place, the correlation of id and x would be near 1.
  const voxel_shapes::VoxelSolid solid = voxel_shapes::ball(10);
  const LeafBlocks blocks = voxel_shapes::blocksOf(solid);
  const std::vector<Seed> seeds =
      placeSeeds(blocks, findParts(blocks, device()), {.pieces = 400, .seed = 2});
  double sum = 0.0, sumX = 0.0;
  for (const Seed& s : seeds) {
    sum += (s.fragment - 200.5) * s.voxel.x();
    sumX += s.voxel.x() * s.voxel.x();
  }
  const double sumId = 400.0 * (400.0 * 400.0 - 1) / 12;
  EXPECT_LT(std::abs(sum) / std::sqrt(sumX * sumId),
            0.2);  // 4 standard deviations of no correlation
}

}  // namespace
}  // namespace sherd
