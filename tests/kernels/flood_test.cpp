// kernels/flood.cl against a flood of one voxel at a time, bit for bit.
#include <sherd/error.h>
#include <sherd/labels.h>

#include <map>
#include <random>

#include "device_fixture.h"
#include "voxel_shapes.h"

namespace sherd {
namespace {

using openvdb::Coord;
using voxel_shapes::VoxelSolid;

struct Owner {
  std::uint16_t fragment;
  std::uint32_t cost;
};

// Floods layer by layer: a free voxel takes the lowest id among its neighbors in the last layer.
std::map<Coord, Owner> referenceFlood(const std::set<Coord>& domain,
                                      std::map<Coord, std::uint16_t> layer, std::uint32_t steps) {
  std::map<Coord, Owner> owned;
  for (const auto& [voxel, id] : layer) owned[voxel] = {id, 0};
  for (std::uint32_t step = 1; step <= steps && !layer.empty(); ++step) {
    std::map<Coord, std::uint16_t> next;
    for (const auto& [voxel, id] : layer) {
      for (const Coord& n : voxel_shapes::neighbors(voxel)) {
        if (!domain.count(n) || owned.count(n)) continue;
        const auto [at, added] = next.try_emplace(n, id);
        if (!added) at->second = std::min(at->second, id);
      }
    }
    for (const auto& [voxel, id] : next) owned[voxel] = {id, step};
    layer = std::move(next);
  }
  return owned;
}

std::vector<Seed> randomSeeds(const VoxelSolid& solid, int count, unsigned seed) {
  std::minstd_rand random(seed + 1);
  const std::vector<Coord> voxels(solid.inside.begin(), solid.inside.end());
  std::map<Coord, Seed> seeds;  // distinct voxels
  for (int i = 1; i <= count; ++i) {
    const Coord voxel = voxels[random() % voxels.size()];
    seeds[voxel] = {
        voxel, static_cast<std::uint16_t>(1 + random() % 9)};  // ids repeat: ties and merged seeds
  }
  std::vector<Seed> list;
  for (const auto& [voxel, s] : seeds) list.push_back(s);
  return list;
}

// Compares every voxel of the arrays; voxels outside the solid and its exterior band must be 0.
void expectEqual(const VoxelSolid& solid, const std::vector<Seed>& seeds, const Labels& labels,
                 int outerSteps) {
  const auto blocks = voxel_shapes::blocksOf(solid);
  std::map<Coord, std::uint16_t> start;
  for (const Seed& s : seeds) start[s.voxel] = s.fragment;
  const std::map<Coord, Owner> inside = referenceFlood(solid.inside, start, ~0u);
  std::map<Coord, std::uint16_t> all;
  for (const auto& [voxel, owner] : inside) all[voxel] = owner.fragment;
  const std::map<Coord, Owner> extended =
      referenceFlood(solid.exteriorBand, all, static_cast<std::uint32_t>(outerSteps));

  std::vector<std::uint16_t> fragment(blocks->count() * 512, 0);
  std::vector<std::uint32_t> cost(labels.cost.size(), 0);
  for (const auto& [voxel, owner] : extended) {
    fragment[voxel_shapes::voxelIndexOf(*blocks, voxel)] = owner.fragment;
  }
  EXPECT_EQ(labels.fragment, fragment) << solid.name;
  if (labels.cost.empty()) return;
  for (const auto& [voxel, owner] : inside)
    cost[voxel_shapes::voxelIndexOf(*blocks, voxel)] = owner.cost;
  for (const Coord& voxel : solid.exteriorBand) {  // the cost is defined for inside voxels only
    const std::size_t at = voxel_shapes::voxelIndexOf(*blocks, voxel);
    cost[at] = labels.cost[at];
  }
  EXPECT_EQ(labels.cost, cost) << solid.name;
}

using Flood = DeviceTest;

TEST_F(Flood, EqualsTheReferenceOnEveryShape) {
  const std::vector<int> counts =
      voxel_shapes::small() ? std::vector<int>{12} : std::vector<int>{1, 2, 12, 200};
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    for (const int seedCount : counts) {
      const std::vector<std::vector<Seed>> sets{
          randomSeeds(solid, seedCount, static_cast<unsigned>(seedCount))};
      const std::vector<Labels> labels = grow(
          voxel_shapes::blocksOf(solid), sets, device(),
          {.growth = Growth::flood, .regrowIsolated = false, .keepCost = true, .outerSteps = 6});
      ASSERT_EQ(labels.size(), 1u);
      expectEqual(solid, sets[0], labels[0], 6);
    }
  }
}

TEST_F(Flood, AnyBatchAndWorkGroupAndReadbackGiveTheSameLabels) {
  const VoxelSolid solid = voxel_shapes::all()[1];
  const auto blocks = voxel_shapes::blocksOf(solid);
  std::vector<std::vector<Seed>> sets;
  for (unsigned i = 0; i < 3; ++i)
    sets.push_back(randomSeeds(solid, 3 + 7 * static_cast<int>(i), i));
  for (const int group : {1, 3, 64}) {
    for (const int readback :
         voxel_shapes::small() ? std::vector<int>{8} : std::vector<int>{1, 5, 64}) {
      const std::vector<Labels> together =
          grow(blocks, sets, device(),
               {.growth = Growth::flood,
                .regrowIsolated = false,
                .outerSteps = 4,
                .tuning = {.stepsPerReadback = readback, .workGroupSize = group}});
      ASSERT_EQ(together.size(), sets.size());
      for (std::size_t i = 0; i < sets.size(); ++i) expectEqual(solid, sets[i], together[i], 4);
    }
  }
}

TEST_F(Flood, TiesGoToTheLowerId) {
  const VoxelSolid bar = voxel_shapes::solidWhere("bar", 10, [](const Coord& v) {
    return v.y() == 0 && v.z() == 0 && v.x() >= -10 && v.x() <= 10;
  });
  const auto blocks = voxel_shapes::blocksOf(bar);
  const std::vector<std::vector<Seed>> sets{{{{-10, 0, 0}, 2}, {{10, 0, 0}, 1}},
                                            {{{-10, 0, 0}, 1}, {{10, 0, 0}, 2}}};
  const std::vector<Labels> labels = grow(blocks, sets, device(), {.growth = Growth::flood});
  const std::size_t middle = voxel_shapes::voxelIndexOf(*blocks, {0, 0, 0});
  EXPECT_EQ(labels[0].fragment[middle], 1);
  EXPECT_EQ(labels[1].fragment[middle], 1);
  EXPECT_EQ(labels[0].fragment[voxel_shapes::voxelIndexOf(*blocks, {-1, 0, 0})], 2);
}

TEST_F(Flood, ComponentsWithoutASeedStayUnlabeled) {
  const VoxelSolid two = voxel_shapes::solidWhere("two cubes", 9, [](const Coord& v) {
    return std::abs(v.y()) < 3 && std::abs(v.z()) < 3 && std::abs(v.x()) > 4;
  });
  const auto blocks = voxel_shapes::blocksOf(two);
  const std::vector<std::vector<Seed>> sets{{{{-6, 0, 0}, 1}}};
  const Labels labels =
      grow(blocks, sets, device(), {.growth = Growth::flood, .outerSteps = 0}).front();
  const std::vector<std::uint64_t> counts = countVoxels(labels);
  EXPECT_EQ(counts, (std::vector<std::uint64_t>{125, 125}));
}

TEST_F(Flood, RefusesASeedOutsideTheSolid) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::ball(5));
  const std::vector<std::vector<Seed>> sets{{{{6, 0, 0}, 1}}};
  EXPECT_THROW((void)grow(blocks, sets, device()), Error);
}

}  // namespace
}  // namespace sherd
