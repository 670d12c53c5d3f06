// The least voxels of fragments.
#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/fracture.h>

#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "folder/manifest/small_pieces.h"
#include "grow/sized/raise_small.h"
#include "kernels/voxel_shapes.h"
#include "shapes.h"
#include "unit/erode/erode_reference.h"

namespace sherd {
namespace {

using erode_reference::Labeled;
using openvdb::Coord;
using VoxelSets = std::map<int, std::set<Coord>>;

// The voxels of each fragment.
VoxelSets setsOf(const Labels& labels) {
  VoxelSets sets;
  labels.blocks->forEachInside([&](std::size_t voxel) {
    const std::uint16_t label = labels.fragment[voxel];
    if (label != 0 && label != Labels::kEroded) sets[label].insert(labels.blocks->voxelAt(voxel));
  });
  return sets;
}

// Whether voxels are connected over faces.
bool areConnected(std::set<Coord> voxels) {
  std::vector<Coord> open{*voxels.begin()};
  voxels.erase(voxels.begin());
  while (!open.empty()) {
    const Coord at = open.back();
    open.pop_back();
    for (const Coord& next : voxel_shapes::neighbors(at)) {
      if (voxels.erase(next) > 0) open.push_back(next);
    }
  }
  return voxels.empty();
}

void expectPieces(const Labels& labels, std::size_t fragments, std::uint64_t least) {
  const VoxelSets sets = setsOf(labels);
  ASSERT_EQ(sets.size(), fragments);
  for (const auto& [id, voxels] : sets) {
    EXPECT_GE(voxels.size(), least) << "fragment " << id;
    EXPECT_TRUE(areConnected(voxels)) << "fragment " << id;
  }
}

std::uint64_t smallest(const FractureResult& result) {
  std::uint64_t least = ~std::uint64_t{0};
  for (const Fragment& fragment : result.fragments) least = std::min(least, fragment.voxels);
  return least;
}

// The rule of kAutoShare, as its page has it.
std::uint64_t floorOf(const FractureResult& result) {
  return std::min<std::uint64_t>(27, result.solid.voxels / (4 * result.fragments.size()));
}

TEST(SmallFragments, OneVoxelGrowsAtTheCostOfItsNeighbors) {
  Labeled ball = erode_reference::labeled(voxel_shapes::ball(9), 3, [](const Coord& v) {
    return v == Coord(0, 4, 5) ? 3 : v.x() < 0 ? 1 : 2;
  });
  const auto changed = raiseSmallFragments(ball.labels, 27);
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_EQ(changed[0].first, 3);
  expectPieces(ball.labels, 3, 27);
  const VoxelSets sets = setsOf(ball.labels);
  EXPECT_EQ(sets.at(3).size(), 27u);
  EXPECT_EQ(sets.at(3).count({0, 4, 5}), 1u);
  EXPECT_TRUE(raiseSmallFragments(ball.labels, 27).empty());
}

TEST(SmallFragments, OneThatAnotherEnclosesMovesToItsSurface) {
  Labeled ball = erode_reference::labeled(
      voxel_shapes::ball(9), 2, [](const Coord& v) { return v == Coord(1, 0, 0) ? 2 : 1; });
  const auto changed = raiseSmallFragments(ball.labels, 27);
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_EQ(changed[0].first, 2);
  expectPieces(ball.labels, 2, 27);
  // What is not of the other one is connected with the outside: the other has no cavity.
  const VoxelSets sets = setsOf(ball.labels);
  std::set<Coord> others;
  for (int x = -11; x <= 11; ++x) {
    for (int y = -11; y <= 11; ++y) {
      for (int z = -11; z <= 11; ++z) {
        if (sets.at(1).count({x, y, z}) == 0) others.insert({x, y, z});
      }
    }
  }
  EXPECT_TRUE(areConnected(others));
}

TEST(SmallFragments, NoNeighborIsDivided) {
  // A rod of one voxel between two balls, which nothing may take from it, and one voxel beside it.
  const voxel_shapes::VoxelSolid solid = voxel_shapes::solidWhere("rod", 14, [](const Coord& v) {
    const bool isRod = v.y() == 0 && v.z() == 0;
    const int x = std::abs(v.x()) - 9;
    return isRod ? std::abs(v.x()) < 12
                 : x * x + v.y() * v.y() + v.z() * v.z() < 20 ||
                       (v.x() == 0 && v.y() == 1 && v.z() == 0);
  });
  Labeled rod = erode_reference::labeled(
      solid, 2, [](const Coord& v) { return v == Coord(0, 1, 0) ? 2 : 1; });
  (void)raiseSmallFragments(rod.labels, 27);
  expectPieces(rod.labels, 2, 1);
}

class SmallFragmentsOf : public ::testing::TestWithParam<FractureOptions> {};

TEST_P(SmallFragmentsOf, GrowthsAreNone) {
  Device device("builtin");
  bool hasCrumbs = false;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    FractureOptions options = GetParam();
    options.seed = seed;
    options.surface.meshes = false;
    options.surface.levelSets = false;
    const FractureResult result = fracture(shapes::cup(1.0, 0.2, 1.5, 0.2, 48), options, device);
    ASSERT_EQ(result.fragments.size(), static_cast<std::size_t>(options.pieces));
    expectPieces(result.labels, result.fragments.size(), floorOf(result));
    options.shares.minShare = 0.0;
    const FractureResult any = fracture(shapes::cup(1.0, 0.2, 1.5, 0.2, 48), options, device);
    hasCrumbs |= smallest(any) < floorOf(any);
    const bool warns = !smallPieces(any).empty();
    const double least = std::min(0.001, 0.1 / static_cast<double>(any.fragments.size()));
    EXPECT_EQ(warns,
              static_cast<double>(smallest(any)) < least * static_cast<double>(any.solid.voxels));
  }
  EXPECT_TRUE(hasCrumbs) << "this shows nothing";
}

FractureOptions rough(Growth growth, double roughness) {
  FractureOptions options;
  options.pieces = 80;
  options.solid.resolution = 48;
  options.grow.growth = growth;
  options.grow.roughness = roughness;
  return options;
}

FractureOptions eroded(int pieces, int iterations) {
  FractureOptions options = rough(Growth::euclid, 0.0);
  options.pieces = pieces;
  options.erode.iterations = iterations;
  return options;
}

FractureOptions sized(Growth growth) {
  FractureOptions options = rough(growth, 1.0);
  options.shares.sizes = Sizes::power;
  options.shares.sizeParameter = 2.0;
  return options;
}

INSTANTIATE_TEST_SUITE_P(All, SmallFragmentsOf,
                         ::testing::Values(rough(Growth::euclid, 3.0), rough(Growth::flood, 3.0),
                                           rough(Growth::sequential, 2.0), eroded(12, 20),
                                           eroded(60, 6), sized(Growth::euclid),
                                           sized(Growth::sequential)));

}  // namespace
}  // namespace sherd
