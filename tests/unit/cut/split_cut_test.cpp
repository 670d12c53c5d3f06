// The cut between pieces that were split, against planes.
#include "cut/split_cut.h"

#include <gtest/gtest.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <set>
#include <vector>

#include "shapes.h"

namespace sherd {
namespace {

// Three pieces of a leaf: a plane across x, and one of the positive half across a slanted
// direction.
const std::vector<Split> kSplits{
    {.fragment = 1, .added = 2, .normal = {16384, 0, 0}, .offset = 64 * 16384 * 4 + 32 * 16384},
    {.fragment = 2, .added = 3, .normal = {0, 8000, 6000}, .offset = 64 * 50000}};

double beyond(const Split& split, const openvdb::Coord& v) {
  const glm::dvec3 normal(split.normal);
  return glm::dot(normal, glm::dvec3(v.x(), v.y(), v.z())) / glm::length(normal) -
         static_cast<double>(split.offset) / (64.0 * glm::length(normal));
}

std::uint16_t ownerOf(const openvdb::Coord& v) {
  if (beyond(kSplits[0], v) <= 0.0) return 1;
  return beyond(kSplits[1], v) <= 0.0 ? 2 : 3;
}

CutHalo haloOf(std::uint16_t (*owner)(const openvdb::Coord&)) {
  CutHalo halo{};
  std::size_t at = 0;
  for (int x = -kCutHalo; x < 8 + kCutHalo; ++x) {
    for (int y = -kCutHalo; y < 8 + kCutHalo; ++y) {
      for (int z = -kCutHalo; z < 8 + kCutHalo; ++z) halo[at++] = owner({x, y, z});
    }
  }
  return halo;
}

TEST(SplitCut, IsTheDistanceToThePlanesThatPartedTheFragments) {
  VoxelBits all;
  all.fill(0xff);
  const std::vector<std::uint16_t> fragments{1, 2, 3};
  const SiteCut cut = splitCut(haloOf(ownerOf), {0, 0, 0}, fragments, SplitTree(kSplits), all);
  EXPECT_EQ(cut.holds, all);
  for (int v = 0; v < 512; ++v) {
    const openvdb::Coord voxel(v / 64, v / 8 % 8, v % 8);
    const double first = beyond(kSplits[0], voxel), second = beyond(kSplits[1], voxel);
    const std::vector<double> expected{first, std::max(-first, second), std::max(-first, -second)};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(cut.distance[k * 512 + static_cast<std::size_t>(v)],
                  std::clamp(expected[k], -3.0, 3.0), 1e-6);
    }
  }
}

// A fragment is bounded only by the planes that parted it from fragments that are there: without
// the first one the plane across x does not matter.
TEST(SplitCut, LeavesOutPlanesOfFragmentsThatAreElsewhere) {
  VoxelBits all;
  all.fill(0xff);
  const auto owner = [](const openvdb::Coord& v) -> std::uint16_t {
    return beyond(kSplits[1], v) <= 0.0 ? 2 : 3;
  };
  const std::vector<std::uint16_t> fragments{2, 3};
  const SiteCut cut = splitCut(haloOf(owner), {0, 0, 0}, fragments, SplitTree(kSplits), all);
  EXPECT_EQ(cut.holds, all);
  EXPECT_NEAR(cut.distance[0], std::clamp(beyond(kSplits[1], {0, 0, 0}), -3.0, 3.0), 1e-6);
}

// A voxel on the wrong side of its plane, as of a component that joined the other side.
TEST(SplitCut, DoesNotHoldNearVoxelsOnTheOtherSide) {
  VoxelBits all;
  all.fill(0xff);
  CutHalo halo = haloOf(ownerOf);
  halo[(0 + kCutHalo) * kCutSide * kCutSide + (0 + kCutHalo) * kCutSide + kCutHalo] = 3;  // (0,0,0)
  const std::vector<std::uint16_t> fragments{1, 2, 3};
  const SiteCut cut = splitCut(halo, {0, 0, 0}, fragments, SplitTree(kSplits), all);
  for (int v = 0; v < 512; ++v) {
    const bool isNear = v / 64 <= 2 && v / 8 % 8 <= 2 && v % 8 <= 2;
    EXPECT_EQ((cut.holds[static_cast<std::size_t>(v / 8)] >> (v % 8)) & 1, isNear ? 0 : 1) << v;
  }
}

TEST(SplitCut, RoughCracksAreNoPlanes) {
  std::vector<Split> rough = kSplits;
  for (Split& split : rough) split.normal = glm::ivec3(0);
  EXPECT_TRUE(SplitTree(rough).empty());
  EXPECT_FALSE(SplitTree(kSplits).empty());
}

// Vertices of cracks lie on the plane of the split that parted the two fragments, but for those
// within a voxel and a half of where a third one meets them: there a vertex is common to both
// planes.
TEST(SplitCut, CracksOfABallAreTheirPlanes) {
  Device device("auto");
  const FractureOptions options{
      .pieces = 9, .seed = 3, .solid = {.resolution = 64}, .grow = {.growth = Growth::sequential}};
  const FractureResult result = fracture(shapes::ball(1.0, 4), options, device);
  const SplitTree splits(result.labels.splits);
  const GridFrame& frame = result.solid.frame;
  double squares = 0.0;
  std::size_t count = 0;
  for (const Fragment& fragment : result.fragments) {
    std::map<std::uint32_t, std::set<int>> neighborsOf;
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        neighborsOf[static_cast<std::uint32_t>(fragment.mesh.triangles[t][k])].insert(
            fragment.mesh.neighbor[t]);
      }
    }
    for (const auto& [vertex, neighbors] : neighborsOf) {
      if (neighbors.size() > 1 || *neighbors.begin() == 0) continue;
      const auto other = static_cast<std::uint16_t>(*neighbors.begin());
      const SplitTree::Side* side = splits.parted(static_cast<std::uint16_t>(fragment.id), other);
      ASSERT_NE(side, nullptr);
      const Split& split = result.labels.splits[side->split];
      const glm::dvec3 normal(split.normal);
      const glm::dvec3 at = frame.indexFromWorld(fragment.mesh.vertices[vertex]);
      const double away = glm::dot(normal, at) / glm::length(normal) -
                          static_cast<double>(split.offset) / (64.0 * glm::length(normal));
      squares += away * away;
      ++count;
    }
  }
  ASSERT_GT(count, 1000u);
  // The clamp of 0.05 voxel that keeps voxels on their owner's side, decision 12.
  EXPECT_LT(std::sqrt(squares / static_cast<double>(count)), 0.05);
}

}  // namespace
}  // namespace sherd
