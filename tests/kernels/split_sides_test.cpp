// split_by_sides in split.cl against a plain loop over voxels, bit for bit.
#include <algorithm>
#include <map>

#include "device_fixture.h"
#include "grow/splits/sequential.h"
#include "voxel_shapes.h"

namespace sherd {
namespace {

using SplitSides = DeviceTest;

std::vector<std::uint64_t> sideWhere(const LeafBlocks& blocks,
                                     const std::function<bool(const openvdb::Coord&)>& isPositive) {
  std::vector<std::uint64_t> side(blocks.inside.size(), 0);
  blocks.forEachInside([&](std::size_t voxel) {
    if (isPositive(blocks.voxelAt(voxel))) side[voxel / 64] |= std::uint64_t{1} << (voxel % 64);
  });
  return side;
}

// A ball, cut by three planes and a smaller ball: its parts are connected, and leaves in the middle
// have four.
TEST_F(SplitSides, EqualTheSideOfEachVoxel) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::ball(21));
  const VoxelComponents components = findComponents(*blocks, device());
  const GuideSides guides{{
      sideWhere(*blocks, [](const auto& v) { return 3 * v.x() + v.y() > 2; }),
      sideWhere(*blocks, [](const auto& v) { return v.z() - v.x() > 1; }),
      sideWhere(*blocks, [](const auto& v) { return v.y() > 100; }),  // beside the ball
      sideWhere(*blocks,
                [](const auto& v) { return v.x() * v.x() + v.y() * v.y() + v.z() * v.z() < 100; }),
  }};
  const std::vector<SplitRun> runs{
      {.shares = std::vector<double>(8, 1.0 / 8), .seed = 1, .guides = &guides},
      {.shares = std::vector<double>(8, 1.0 / 8), .seed = 2, .guides = &guides}};
  const std::vector<SeededLabels> grown =
      growBySplits(blocks, components, runs, device(), GrowOptions{.growth = Growth::sequential});
  ASSERT_EQ(grown.size(), 2u);
  for (const SeededLabels& each : grown) {
    const std::vector<Split>& splits = each.labels.splits;
    ASSERT_EQ(splits.size(), 7u);
    std::map<std::uint16_t, std::uint16_t> addedTo[4];  // of each guide, by the piece that is split
    std::uint16_t first = splits.front().fragment;
    for (const Split& split : splits) {
      EXPECT_EQ(split.normal, glm::ivec3(0));
      addedTo[split.offset][split.fragment] = split.added;
    }
    blocks->forEachInside([&](std::size_t voxel) {
      std::uint16_t label = first;
      for (std::size_t guide = 0; guide < guides.positive.size(); ++guide) {
        const bool isPositive = (guides.positive[guide][voxel / 64] >> (voxel % 64)) & 1;
        const auto added = addedTo[guide].find(label);
        if (isPositive && added != addedTo[guide].end()) label = added->second;
      }
      ASSERT_EQ(each.labels.fragment[voxel], label) << blocks->voxelAt(voxel);
    });
  }
}

// Two halves of a cup's wall are one component, and of two islands each has a piece of its own.
TEST_F(SplitSides, LeaveConnectedPieces) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::cup(20, 3));
  const VoxelComponents components = findComponents(*blocks, device());
  const GuideSides guides{{sideWhere(*blocks, [](const auto& v) { return std::abs(v.x()) > 12; })}};
  const std::vector<SplitRun> runs{
      {.shares = std::vector<double>(6, 1.0 / 6), .seed = 3, .guides = &guides}};
  const Labels labels = std::move(
      growBySplits(blocks, components, runs, device(), GrowOptions{.growth = Growth::sequential})
          .front()
          .labels);
  const std::vector<std::uint64_t> voxels = countVoxels(labels);
  ASSERT_EQ(voxels.size(), 7u);
  for (std::uint16_t id = 1; id <= 6; ++id) {
    std::set<openvdb::Coord> own;
    blocks->forEachInside([&](std::size_t voxel) {
      if (labels.fragment[voxel] == id) own.insert(blocks->voxelAt(voxel));
    });
    ASSERT_FALSE(own.empty());
    std::vector<openvdb::Coord> next{*own.begin()};
    std::set<openvdb::Coord> reached(next.begin(), next.end());
    while (!next.empty()) {
      const openvdb::Coord at = next.back();
      next.pop_back();
      for (const openvdb::Coord& beside : voxel_shapes::neighbors(at)) {
        if (own.count(beside) && reached.insert(beside).second) next.push_back(beside);
      }
    }
    EXPECT_EQ(reached.size(), own.size()) << id;
  }
}

}  // namespace
}  // namespace sherd
