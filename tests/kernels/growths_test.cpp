// nearest.cl, levels.cl and the regrowth of disconnected voxels against references, bit for bit.
#include <sherd/error.h>
#include <sherd/labels.h>

#include <algorithm>
#include <random>

#include "cl/device_impl.h"
#include "device_fixture.h"
#include "grow_reference.h"
#include "random_ways.h"

namespace sherd {
namespace {

using openvdb::Coord;
using reference::LabelMap;
using voxel_shapes::VoxelSolid;

using Growths = DeviceTest;

// Distinct voxels; the first `fragments` seeds have ids 1..fragments, the others repeat these ids.
std::vector<Seed> randomSeeds(const VoxelSolid& solid, std::size_t fragments, std::size_t extra,
                              unsigned seed) {
  std::vector<Coord> voxels(solid.inside.begin(), solid.inside.end());
  std::mt19937 random(seed);
  std::shuffle(voxels.begin(), voxels.end(), random);
  fragments = std::min(fragments, voxels.size());
  extra = std::min(extra, voxels.size() - fragments);
  std::vector<Seed> seeds;
  for (std::size_t i = 0; i < fragments + extra; ++i) {
    seeds.push_back({voxels[i], static_cast<std::uint16_t>(1 + (i * 7 + 3) % fragments)});
    for (int axis = 0; axis < 3; ++axis) {
      seeds.back().shift[axis] = static_cast<int>(random() % (2 * kMostShift + 1)) - kMostShift;
    }
  }
  for (std::size_t i = 0; i < fragments; ++i) seeds[i].fragment = static_cast<std::uint16_t>(i + 1);
  return seeds;
}

std::vector<Labels> growOne(const VoxelSolid& solid, const std::vector<Seed>& seeds, Device& device,
                            GrowOptions options) {
  const std::vector<std::vector<Seed>> sets{seeds};
  const auto blocks = voxel_shapes::blocksOf(solid);
  options.keepCost = false;
  const std::vector<Labels> plain = grow(blocks, sets, device, options);
  options.keepCost = true;
  std::vector<Labels> withCost = grow(blocks, sets, device, options);
  EXPECT_EQ(plain.front().fragment, withCost.front().fragment)
      << solid.name << ": the labels without the cost, which leaves may have as a whole";
  return withCost;
}

LabelMap labelsOf(const std::map<Coord, reference::Arrival>& arrivals) {
  LabelMap labels;
  for (const auto& [voxel, arrival] : arrivals) labels[voxel] = arrival.label;
  return labels;
}

LabelMap startOf(const std::vector<Seed>& seeds) {
  LabelMap start;
  for (const Seed& seed : seeds) start.try_emplace(seed.voxel, seed.fragment);
  return start;
}

void expectCosts(const VoxelSolid& solid, const Labels& labels,
                 const std::map<Coord, reference::Arrival>& arrivals) {
  const auto blocks = voxel_shapes::blocksOf(solid);
  std::size_t wrong = 0;
  for (const auto& [voxel, arrival] : arrivals) {
    wrong += labels.cost[voxel_shapes::voxelIndexOf(*blocks, voxel)] != arrival.cost;
  }
  EXPECT_EQ(wrong, 0u) << solid.name;
}

TEST_F(Growths, NearestEqualsBruteForceForEveryMetric) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    for (const Metric metric : {Metric::euclidean, Metric::chebyshev, Metric::manhattan}) {
      for (const std::size_t count : voxel_shapes::small() ? std::vector<std::size_t>{3}
                                                           : std::vector<std::size_t>{1, 9, 60}) {
        const std::vector<Seed> seeds = randomSeeds(solid, count, count / 3, 5);
        const Labels labels =
            growOne(solid, seeds, device(),
                    {.growth = Growth::nearest, .metric = metric, .regrowIsolated = false})
                .front();
        const auto reference = reference::nearest(solid, seeds, metric);
        EXPECT_EQ(reference::mapOf(labels), labelsOf(reference)) << solid.name;
        expectCosts(solid, labels, reference);
      }
    }
  }
}

// Weights of up to 40 voxels squared, mostly more than the distance of two seeds: hosts lower those
// that would leave another seed without its own voxel.
TEST_F(Growths, WeightedSeedsGivePowerCellsAroundTheirVoxels) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    for (const std::size_t count : {2u, 30u}) {
      std::vector<Seed> seeds = randomSeeds(solid, count, count / 3, 6);
      std::mt19937 random(7);
      for (Seed& seed : seeds) {
        seed.weight = static_cast<std::int64_t>(random() % (80 * kSeedSteps * kSeedSteps)) -
                      40 * kSeedSteps * kSeedSteps;
      }
      const Labels labels =
          growOne(solid, seeds, device(), {.growth = Growth::nearest, .regrowIsolated = false})
              .front();
      const std::vector<Seed>& settled = labels.sites.seeds;
      EXPECT_EQ(reference::settled(settled, Metric::euclidean), settled);
      const auto reference = reference::nearest(solid, settled, Metric::euclidean);
      EXPECT_EQ(reference::mapOf(labels), labelsOf(reference)) << solid.name;
      expectCosts(solid, labels, reference);
      bool anyWeight = false;
      for (const Seed& seed : settled) {
        anyWeight |= seed.weight != settled.front().weight;
        EXPECT_EQ(reference.at(seed.voxel).label, seed.fragment) << solid.name;
      }
      EXPECT_TRUE(anyWeight) << solid.name;
    }
  }
}

// In one batch a fracture in walls and one without; with weights and costs.
TEST_F(Growths, NearestInWallsEqualsBruteForceAtTheirMiddle) {
  int compared = 0;
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    const std::shared_ptr<const WallMiddles> ways = randomWays(blocks);
    const auto wayOf = [&](const Coord& voxel) {
      const std::size_t first = 3 * voxel_shapes::voxelIndexOf(*blocks, voxel);
      return glm::ivec3(ways->ways()[first], ways->ways()[first + 1], ways->ways()[first + 2]);
    };
    for (const bool isWeighted : {false, true}) {
      std::vector<std::vector<Seed>> sets(2, randomSeeds(solid, 9, 3, 5));
      std::mt19937 random(7);
      for (Seed& seed : sets[0]) {
        if (isWeighted) seed.weight = static_cast<std::int64_t>(random() % 9000);
      }
      GrowOptions options{.growth = Growth::nearest, .regrowIsolated = false, .walls = {ways}};
      const std::vector<Labels> plain = grow(blocks, sets, device(), options);
      options.keepCost = true;
      const std::vector<Labels> both = grow(blocks, sets, device(), options);
      EXPECT_EQ(plain[0].fragment, both[0].fragment) << solid.name;
      EXPECT_EQ(plain[1].fragment, both[1].fragment) << solid.name;
      EXPECT_EQ(both[1].walls, nullptr);
      EXPECT_EQ(reference::mapOf(both[1]),
                labelsOf(reference::nearest(solid, sets[1], Metric::euclidean)));
      if (both[0].walls == nullptr) continue;  // two seeds have one middle
      ++compared;
      const std::vector<Seed>& settled = both[0].sites.seeds;
      const auto reference = reference::nearestInWalls(solid, settled, wayOf);
      EXPECT_EQ(reference::mapOf(both[0]), labelsOf(reference)) << solid.name;
      expectCosts(solid, both[0], reference);
      for (const Seed& seed : settled) EXPECT_EQ(reference.at(seed.voxel).label, seed.fragment);
    }
  }
  EXPECT_EQ(compared, 2 * static_cast<int>(voxel_shapes::all().size()));
}

TEST_F(Growths, SeedsWithOneMiddleGrowWithoutWalls) {
  const VoxelSolid solid = voxel_shapes::ball(5);
  const auto blocks = voxel_shapes::blocksOf(solid);
  const std::vector<std::vector<Seed>> sets{{{{0, 0, -1}, 1}, {{0, 0, 1}, 2}}};
  std::vector<std::int16_t> ways(blocks->count() * 512 * 3, 0);
  for (const Seed& seed : sets[0]) {
    ways[3 * voxel_shapes::voxelIndexOf(*blocks, seed.voxel) + 2] =
        static_cast<std::int16_t>(-kSeedSteps * seed.voxel.z());
  }
  const Labels expected = grow(blocks, sets, device(), {.growth = Growth::euclid}).front();
  const GrowOptions options{.growth = Growth::euclid,
                            .walls = {std::make_shared<const WallMiddles>(blocks, ways)}};
  const Labels labels = grow(blocks, sets, device(), options).front();
  EXPECT_EQ(labels.walls, nullptr);
  EXPECT_EQ(labels.fragment, expected.fragment);
  EXPECT_THROW((void)grow(voxel_shapes::blocksOf(voxel_shapes::ball(15)), sets, device(), options),
               Error);
}

TEST_F(Growths, EqualWeightsChangeNothing) {
  const VoxelSolid solid = voxel_shapes::ball(voxel_shapes::small() ? 5 : 9);
  const auto blocks = voxel_shapes::blocksOf(solid);
  for (const double strength : {0.0, 1.0}) {
    std::vector<Seed> seeds = randomSeeds(solid, 20, 5, 6);
    const GrowOptions options{.growth = Growth::nearest, .anisotropy = {{1, 2, 0}, strength}};
    const Labels plain = std::move(grow(blocks, std::span(&seeds, 1), device(), options).front());
    for (Seed& seed : seeds) seed.weight = -5000;
    const Labels weighted =
        std::move(grow(blocks, std::span(&seeds, 1), device(), options).front());
    EXPECT_EQ(plain.fragment, weighted.fragment);
  }
}

TEST_F(Growths, MooreFloodEqualsDijkstra) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    const std::vector<Seed> seeds = randomSeeds(solid, 7, 3, 1);
    const Labels labels =
        growOne(solid, seeds, device(),
                {.growth = Growth::flood, .neighborhood = 26, .regrowIsolated = false})
            .front();
    const auto reference = reference::dijkstra(solid.inside, startOf(seeds), reference::moore());
    EXPECT_EQ(reference::mapOf(labels), labelsOf(reference)) << solid.name;
    expectCosts(solid, labels, reference);
  }
}

// The reference repeats each stage: nearest, chamfer regrowth, regrowth over faces.
TEST_F(Growths, EuclidEqualsItsStagesOneByOne) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    const std::vector<Seed> seeds = randomSeeds(solid, 7, 5, 2);
    const Labels labels = growOne(solid, seeds, device(), {.growth = Growth::euclid}).front();

    const LabelMap nearest = labelsOf(reference::nearest(solid, seeds, Metric::euclidean));
    LabelMap kept = reference::kept(nearest, seeds);
    ASSERT_GE(labels.disconnected.size(), 1u);
    EXPECT_EQ(labels.disconnected[0], nearest.size() - kept.size()) << solid.name;
    LabelMap grown = labelsOf(reference::dijkstra(solid.inside, kept, reference::chamfer()));
    kept = reference::kept(grown, seeds);
    std::vector<reference::Step> faces;
    for (const Coord& to : voxel_shapes::neighbors({0, 0, 0})) faces.push_back({to, 1, {}});
    grown = labelsOf(reference::dijkstra(solid.inside, kept, faces));
    EXPECT_EQ(reference::mapOf(labels), grown) << solid.name;
  }
}

// A bar, and a blade beside it whose far end is nearest to a seed of the bar: only leaves around
// the blade may take the eight bytes a voxel of a regrowth.
TEST_F(Growths, RegrowthNeedsMemoryOnlyWhereVoxelsAreDisconnected) {
  VoxelSolid solid{"bar and blade", {}, {}};
  for (int x = 0; x < 160; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) solid.inside.insert({x, y, z});
    }
  }
  for (int x = 0; x < 16; ++x) solid.inside.insert({x, 9, 4});
  solid.inside.insert({0, 8, 4});
  const auto blocks = voxel_shapes::blocksOf(solid);
  const std::vector<std::vector<Seed>> sets{{{{0, 0, 0}, 1}, {{12, 4, 4}, 2}}};
  const Labels expected = std::move(grow(blocks, sets, device()).front());
  EXPECT_EQ(expected.disconnected.front(), 12u);  // of the blade, x² + 97 > (x - 12)² + 25

  Device small(device().info().name);
  implOf(small).info.largestBufferBytes = blocks->count() * 512 * sizeof(std::uint16_t);
  const Labels grown = std::move(grow(blocks, sets, small).front());
  EXPECT_EQ(grown.fragment, expected.fragment);
  EXPECT_EQ(grown.disconnected, expected.disconnected);
}

// Chain growth by passes over all offers, in the order of levels.cl.
LabelMap referenceChain(const VoxelSolid& solid, const std::vector<Seed>& seeds, Metric metric) {
  struct Owner {
    std::uint64_t cost;
    std::uint16_t label;
    Coord seed;
  };
  std::map<Coord, Owner> owned;
  for (const Seed& seed : seeds) owned[seed.voxel] = {0, seed.fragment, seed.voxel};
  const auto bucketAbove = [&](std::uint64_t distance) {
    if (metric != Metric::euclidean) return distance;
    std::uint64_t n = 0;
    while (n * n < 4 * distance) ++n;
    return n * n / 4;
  };
  const auto before = [&](const Owner& a, const Owner& b) {
    if (a.cost != b.cost) return a.cost < b.cost;
    if (a.label != b.label) return a.label < b.label;
    return voxel_shapes::leafOrder(a.seed, b.seed);
  };
  std::uint64_t threshold = 0;
  std::map<Coord, Owner> front = owned;  // voxels that may have free neighbors
  for (;;) {
    std::map<Coord, Owner> offers;
    for (auto at = front.begin(); at != front.end();) {
      const auto [voxel, owner] = *at;
      bool offered = false;
      for (const Coord& n : voxel_shapes::neighbors(voxel)) {
        if (!solid.inside.count(n) || owned.count(n)) continue;
        offered = true;
        Owner offer = owner;
        offer.cost = std::max(owner.cost, reference::distance(metric, n, owner.seed));
        const auto [best, added] = offers.try_emplace(n, offer);
        if (!added && before(offer, best->second)) best->second = offer;
      }
      at = offered ? std::next(at) : front.erase(at);
    }
    if (offers.empty()) break;
    std::uint64_t least = ~0ull;
    bool took = false;
    for (const auto& [voxel, offer] : offers) {
      if (offer.cost <= threshold) {
        owned[voxel] = front[voxel] = offer;
        took = true;
      }
      least = std::min(least, offer.cost);
    }
    if (!took) threshold = bucketAbove(least);
  }
  LabelMap labels;
  for (const auto& [voxel, owner] : owned) labels[voxel] = owner.label;
  return labels;
}

TEST_F(Growths, ChainEqualsTheReferenceAndIsConnected) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    for (const Metric metric : {Metric::euclidean, Metric::chebyshev, Metric::manhattan}) {
      const std::vector<Seed> seeds = randomSeeds(solid, 6, 0, 3);
      const Labels labels =
          growOne(solid, seeds, device(), {.growth = Growth::chain, .metric = metric}).front();
      const LabelMap map = reference::mapOf(labels);
      EXPECT_EQ(map, referenceChain(solid, seeds, metric)) << solid.name;
      EXPECT_EQ(reference::countConnectedComponents(map), seeds.size()) << solid.name;
    }
  }
}

TEST_F(Growths, EveryGrowthGivesConnectedFragmentsThatCoverTheirComponents) {
  const bool small = voxel_shapes::small();
  const VoxelSolid solid = small ? voxel_shapes::cup(6, 2) : voxel_shapes::cup(11, 3);
  const auto blocks = voxel_shapes::blocksOf(solid);
  for (const Growth growth : {Growth::flood, Growth::nearest, Growth::chain, Growth::euclid}) {
    for (const int neighborhood : {6, 26}) {
      if (small && neighborhood == 6) continue;
      for (const double roughness : {0.0, 1.5}) {
        for (const double strength : {0.0, 2.0, -0.5}) {
          if (small && (strength < 0.0) == (roughness > 0.0)) continue;
          const std::vector<Seed> seeds = randomSeeds(solid, 9, 14, 4);
          const Labels labels = growOne(solid, seeds, device(),
                                        {.growth = growth,
                                         .neighborhood = neighborhood,
                                         .anisotropy = {{1, 2, 0}, strength},
                                         .roughness = roughness})
                                    .front();
          const LabelMap map = reference::mapOf(labels);
          EXPECT_EQ(map.size(), solid.inside.size());
          EXPECT_EQ(reference::countConnectedComponents(map), 9u);
          if (roughness == 0.0) {
            EXPECT_EQ(reference::kept(map, seeds).size(), map.size());
          }
        }
      }
    }
  }
}

// A volume's voxels may lie anywhere: 64 steps of a seed to each voxel pass 32 bits here.
TEST_F(Growths, DoNotDependOnTheDistanceFromTheOrigin) {
  const VoxelSolid solid =
      voxel_shapes::small() ? voxel_shapes::cup(6, 2) : voxel_shapes::cup(11, 3);
  const auto blocks = voxel_shapes::blocksOf(solid);
  const openvdb::Coord away(1 << 28, -(1 << 28), (1 << 27) + 8);
  LeafBlocks far = *blocks;
  for (openvdb::Coord& origin : far.origins) origin += away;
  const auto farBlocks = std::make_shared<const LeafBlocks>(std::move(far));
  const std::vector<std::vector<Seed>> sets{randomSeeds(solid, 9, 5, 2)};
  std::vector<std::vector<Seed>> farSets = sets;
  for (Seed& seed : farSets[0]) seed.voxel += away;
  for (const Growth growth : {Growth::flood, Growth::nearest, Growth::chain, Growth::euclid}) {
    const GrowOptions options{.growth = growth, .keepCost = true};
    const Labels here = std::move(grow(blocks, sets, device(), options).front());
    const Labels there = std::move(grow(farBlocks, farSets, device(), options).front());
    EXPECT_EQ(here.fragment, there.fragment);
    EXPECT_EQ(here.cost, there.cost);
  }
}

TEST_F(Growths, BatchesAndWorkGroupsGiveTheSameLabels) {
  const VoxelSolid solid =
      voxel_shapes::small() ? voxel_shapes::cup(6, 2) : voxel_shapes::cup(11, 3);
  const auto blocks = voxel_shapes::blocksOf(solid);
  const std::vector<std::vector<Seed>> sets{
      randomSeeds(solid, 3, 0, 1), randomSeeds(solid, 12, 20, 2), randomSeeds(solid, 1, 0, 3)};
  for (const Growth growth : {Growth::flood, Growth::nearest, Growth::chain, Growth::euclid}) {
    GrowOptions options{.growth = growth, .neighborhood = 26, .roughness = 1.0};
    options.keepCost = true;
    options.noiseSeeds = {11, 22, 33};
    const std::vector<Labels> together = grow(blocks, sets, device(), options);
    for (std::size_t i = 0; i < sets.size(); ++i) {
      GrowOptions alone = options;
      alone.noiseSeeds = {options.noiseSeeds[i]};
      alone.tuning.workGroupSize = static_cast<int>(1 + i);
      const Labels single =
          std::move(grow(blocks, std::span(&sets[i], 1), device(), alone).front());
      EXPECT_EQ(single.fragment, together[i].fragment);
      EXPECT_EQ(single.cost, together[i].cost);
    }
  }
}

// The device's largest allocation holds two of three fractures, then less than one.
TEST_F(Growths, FracturesThatExceedTheLargestBufferGrowInBatches) {
  const VoxelSolid solid = voxel_shapes::ball(5);
  const auto blocks = voxel_shapes::blocksOf(solid);
  const std::vector<std::vector<Seed>> sets{
      randomSeeds(solid, 3, 0, 1), randomSeeds(solid, 5, 0, 2), randomSeeds(solid, 2, 0, 3)};
  const std::size_t perFracture = blocks->count() * 512 * sizeof(std::uint32_t);
  Device small(device().info().name);
  for (const Growth growth : {Growth::flood, Growth::euclid}) {
    GrowOptions options{
        .growth = growth, .roughness = 1.0, .noiseSeeds = {11, 22, 33}, .keepCost = true};
    const Labels withoutWalls = grow(blocks, sets, device(), options).front();
    const auto ways = randomWays(blocks);
    options.walls = {ways, nullptr, ways};
    const std::vector<Labels> together = grow(blocks, sets, device(), options);
    EXPECT_EQ(together[0].fragment != withoutWalls.fragment, growth == Growth::euclid);
    implOf(small).info.largestBufferBytes = 2 * perFracture + 1;
    const std::vector<Labels> inBatches = grow(blocks, sets, small, options);
    ASSERT_EQ(inBatches.size(), sets.size());
    for (std::size_t i = 0; i < sets.size(); ++i) {
      EXPECT_EQ(inBatches[i].fragment, together[i].fragment);
      EXPECT_EQ(inBatches[i].cost, together[i].cost);
    }
    Device little(device().info().name);  // limited by memory instead of the largest allocation
    implOf(little).info.memoryBytes = 2 * 4 * perFracture + 1;
    EXPECT_EQ(grow(blocks, sets, little, options).back().fragment, together.back().fragment);
    EXPECT_LE(little.memory().peakBytes, little.info().memoryBytes);
    implOf(small).info.largestBufferBytes = perFracture / 2;
    EXPECT_THROW((void)grow(blocks, sets, small, options), Error);
  }
}

// The device's memory holds neither free buffers nor rounded-up sizes.
TEST_F(Growths, WithLittleMemoryFreeBuffersAreReleased) {
  const VoxelSolid solid = voxel_shapes::ball(voxel_shapes::small() ? 5 : 20);
  const std::vector<Seed> seeds = randomSeeds(solid, 5, 0, 1);
  for (const Growth growth : {Growth::flood, Growth::nearest, Growth::chain, Growth::euclid}) {
    const GrowOptions options{
        .growth = growth, .roughness = 1.0, .noiseSeeds = {11}, .keepCost = true};
    Device large(device().info().name), least(device().info().name), enough(device().info().name);
    const Labels expected = growOne(solid, seeds, large, options).front();
    implOf(least).info.memoryBytes = 0;
    (void)growOne(solid, seeds, least, options);
    ASSERT_LT(least.memory().peakBytes, large.memory().peakBytes);
    implOf(enough).info.memoryBytes = least.memory().peakBytes * 5 / 4;
    const Labels grown = growOne(solid, seeds, enough, options).front();
    EXPECT_LE(enough.memory().peakBytes, enough.info().memoryBytes);
    EXPECT_EQ(grown.fragment, expected.fragment);
    EXPECT_EQ(grown.cost, expected.cost);
  }
}

TEST_F(Growths, RoughnessMovesOnlyVoxelsNearACrack) {
  const VoxelSolid solid = voxel_shapes::ball(voxel_shapes::small() ? 9 : 20);
  const std::vector<Seed> seeds{{{-5, 0, 0}, 1}, {{5, 1, 0}, 2}};
  const auto map = [&](double roughness) {
    return reference::mapOf(growOne(solid, seeds, device(), {.roughness = roughness}).front());
  };
  const LabelMap smooth = map(0.0), rough = map(1.0);
  std::size_t moved = 0;
  for (const auto& [voxel, label] : smooth) {
    if (rough.at(voxel) == label) continue;
    ++moved;
    EXPECT_LT(std::abs(voxel.x()), 14);
  }
  EXPECT_GT(moved, 0u);
  EXPECT_EQ(map(0.0), smooth);
}

TEST_F(Growths, RefusesOptionsOutOfRange) {
  const VoxelSolid solid = voxel_shapes::ball(4);
  const std::vector<Seed> seeds{{{0, 0, 0}, 1}};
  const auto refused = [&](const GrowOptions& options) {
    EXPECT_THROW((void)growOne(solid, seeds, device(), options), Error);
  };
  refused({.growth = Growth::flood, .neighborhood = 18});
  refused({.anisotropy = {{0, 0, 0}, 1.0}});
  refused({.anisotropy = {{1, 0, 0}, -0.9}});
  refused({.roughness = -1.0});
  refused({.roughness = 1.0, .hurst = 2.0});
  refused({.roughness = 1.0, .longestSideVoxels = 0.5});
}

}  // namespace
}  // namespace sherd
