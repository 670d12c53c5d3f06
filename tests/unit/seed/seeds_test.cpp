// Seed placement: what holds for every sampler.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "seed/nearest_seed.h"
#include "unit/seed/seeds_fixture.h"

namespace sherd {
namespace {

using openvdb::Coord;

class Seeds : public DeviceTest {
 protected:
  static ShapeSolid make(voxel_shapes::VoxelSolid shape) { return {std::move(shape), device()}; }
};

ErrorCode codeOf(const ShapeSolid& on, const SeedOptions& options) {
  try {
    (void)placeSeeds(on.solid, on.components, options);
  } catch (const Error& e) {
    return e.code();
  }
  return ErrorCode::internal;
}

TEST_F(Seeds, LieOnDistinctVoxelsWithIdsWithoutGaps) {
  const ShapeSolid ball = make(voxel_shapes::ball(6));
  const int all = static_cast<int>(ball.solid.voxels);
  for (const int pieces : {1, 7, all / 2, all}) {
    for (const Sampler sampler : kSamplers) {
      const SeedOptions options{.pieces = pieces, .seed = 4, .sampler = sampler};
      expectPromises(ball, placeSeeds(ball.solid, ball.components, options),
                     static_cast<std::size_t>(pieces), 0, options);
    }
  }
  EXPECT_EQ(codeOf(ball, {.pieces = all + 1}), ErrorCode::usage);
  EXPECT_EQ(codeOf(ball, {.pieces = all, .extraSeeds = 1}), ErrorCode::usage);
  EXPECT_EQ(codeOf(ball, {.extraSeeds = -1}), ErrorCode::usage);
  EXPECT_EQ(codeOf(ball, {.randomImpacts = -1}), ErrorCode::usage);
}

TEST_F(Seeds, EveryComponentHasOneWhateverTheSampler) {
  const ShapeSolid sparse = make(voxel_shapes::sparseRandom(10, 30, 6));
  ASSERT_GT(sparse.components.count(), 100u);
  for (const Sampler sampler : kSamplers) {
    for (const SeedsOn on : kPlaces) {
      const SeedOptions options{.pieces = 3, .seed = 1, .sampler = sampler, .on = on};
      expectPromises(sparse, placeSeeds(sparse.solid, sparse.components, options),
                     sparse.components.count(), 0, options);
    }
  }
}

TEST_F(Seeds, FillTheSurfaceWhenAskedForAllOfIt) {
  const auto filled = [](const ShapeSolid& on, Sampler sampler) {
    const int all = static_cast<int>(on.surface().size());
    EXPECT_EQ(codeOf(on, {.pieces = all + 1, .on = SeedsOn::surface}), ErrorCode::usage);
    return voxelsOf(placeSeeds(on.solid, on.components,
                               {.pieces = all, .sampler = sampler, .on = SeedsOn::surface}));
  };
  for (const voxel_shapes::VoxelSolid& shape : voxel_shapes::all()) {
    const ShapeSolid on = make(shape);
    EXPECT_EQ(filled(on, Sampler::uniform), on.surface()) << shape.name;
  }
  const ShapeSolid cup = make(voxel_shapes::cup(6, 2));
  for (const Sampler sampler : kSamplers) EXPECT_EQ(filled(cup, sampler), cup.surface());
}

TEST_F(Seeds, AHundredthOfTheVoxelsIsAlwaysToBeHad) {
  for (const voxel_shapes::VoxelSolid& shape :
       {voxel_shapes::ball(19), voxel_shapes::cup(20, 2), voxel_shapes::cup(20, 1)}) {
    const ShapeSolid on = make(shape);
    const int pieces = static_cast<int>(on.solid.voxels / 100);
    ASSERT_LT(on.components.count(), static_cast<std::size_t>(pieces));
    for (const Sampler sampler : kSamplers) {
      for (const SeedsOn place : kPlaces) {
        const SeedOptions options{
            .pieces = pieces, .seed = 9, .sampler = sampler, .on = place, .extraSeeds = pieces};
        expectPromises(on, placeSeeds(on.solid, on.components, options),
                       static_cast<std::size_t>(pieces), static_cast<std::size_t>(pieces), options);
      }
    }
  }
}

TEST_F(Seeds, AsManyAsThereAreIdsAreToBeHad) {
  const ShapeSolid ball = make(voxel_shapes::ball(26));
  ASSERT_GT(ball.solid.voxels, static_cast<std::uint64_t>(kMaxFragments));
  for (const Sampler sampler : kSamplers) {
    const SeedOptions options{.pieces = kMaxFragments, .sampler = sampler};
    const std::vector<Seed> seeds = placeSeeds(ball.solid, ball.components, options);
    EXPECT_EQ(fragmentsOf(seeds), kMaxFragments);
    EXPECT_EQ(voxelsOf(seeds).size(), seeds.size());
  }
  EXPECT_EQ(codeOf(ball, {.pieces = kMaxFragments + 1}), ErrorCode::usage);
}

TEST_F(Seeds, FurtherOnesTakeTheNearestIdInTheirComponent) {
  for (const voxel_shapes::VoxelSolid& shape :
       {voxel_shapes::ball(10), voxel_shapes::manyComponentsWithin(9)}) {
    const ShapeSolid on = make(shape);
    const int pieces = static_cast<int>(on.components.count()) + 150;
    for (const Metric metric : kMetrics) {
      for (const Sampler sampler : kSamplers) {
        const SeedOptions options{.pieces = pieces,
                                  .seed = 3,
                                  .sampler = sampler,
                                  .extraSeeds = 800,
                                  .mergeMetric = metric};
        expectPromises(on, placeSeeds(on.solid, on.components, options),
                       static_cast<std::size_t>(pieces), 800, options);
      }
    }
  }
}

TEST_F(Seeds, ASpreadGivesFurtherOnesToFewFragments) {
  const ShapeSolid ball = make(voxel_shapes::ball(12));
  constexpr std::size_t kPieces = 10, kExtra = 400;
  double largestEven = 0.0, largest = 0.0;  // numbers of further seeds, of all seed sets
  for (const Metric metric : kMetrics) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      SeedOptions options{
          .pieces = kPieces, .seed = seed, .extraSeeds = kExtra, .mergeMetric = metric};
      const std::vector<Seed> even = placeSeeds(ball.solid, ball.components, options);
      options.sizeSpread = 2.0;
      const std::vector<Seed> uneven = placeSeeds(ball.solid, ball.components, options);
      ASSERT_EQ(even.size(), uneven.size());
      std::vector<double> counts(kPieces + 1), countsEven(kPieces + 1);
      for (std::size_t i = 0; i < even.size(); ++i) {
        EXPECT_EQ(even[i].voxel, uneven[i].voxel);
        if (i < kPieces) {
          EXPECT_EQ(even[i], uneven[i]);
        }
        ++countsEven[even[i].fragment];
        ++counts[uneven[i].fragment];
      }
      largestEven += *std::max_element(countsEven.begin(), countsEven.end());
      largest += *std::max_element(counts.begin(), counts.end());
    }
  }
  EXPECT_GT(largest, 1.5 * largestEven);
  EXPECT_EQ(codeOf(ball, {.sizeSpread = 4.1}), ErrorCode::usage);
  EXPECT_EQ(codeOf(ball, {.sizeSpread = -0.1}), ErrorCode::usage);
}

TEST(NearestSeed, AgreesWithASearchOfAllScaledSites) {
  for (const Metric metric : {Metric::euclidean, Metric::chebyshev, Metric::manhattan}) {
    const auto at = [](std::uint64_t item) {
      glm::i64vec3 p;
      for (int k = 0; k < 3; ++k)
        p[k] = static_cast<std::int64_t>(mixed(3 * item + static_cast<std::uint64_t>(k)) % 1000);
      return p;
    };
    std::vector<NearestSeed::Site> sites;
    for (std::uint16_t id = 1; id <= 200; ++id) {
      sites.push_back({at(id), id, id % 2u, std::ldexp(1.0, static_cast<int>(mixed(id) % 7) - 3)});
    }
    const NearestSeed nearest(sites, 2, metric);
    for (std::uint64_t item = 1000; item < 2000; ++item) {
      const glm::i64vec3 point = at(item);
      for (const std::uint32_t component : {0u, 1u}) {
        double least = 1e300;
        std::uint16_t found = 0;
        for (const NearestSeed::Site& site : sites) {
          const glm::i64vec3 d = site.at - point;
          const double order = static_cast<double>(metricOrder(metric, d.x, d.y, d.z)) / site.scale;
          if (site.component != component || order >= least) continue;
          least = order;
          found = site.fragment;
        }
        ASSERT_EQ(nearest.fragmentAt(point, component), found);
      }
    }
  }
}

TEST_F(Seeds, FurtherOnesDoNotMoveTheFirst) {
  const ShapeSolid ball = make(voxel_shapes::ball(10));
  for (const Sampler sampler : kSamplers) {
    SeedOptions options{.pieces = 50, .seed = 3, .sampler = sampler};
    const std::vector<Seed> without = placeSeeds(ball.solid, ball.components, options);
    options.extraSeeds = 100;
    std::vector<Seed> with = placeSeeds(ball.solid, ball.components, options);
    with.resize(50);
    EXPECT_EQ(without, with);
  }
}

TEST_F(Seeds, AreSettledByTheSeed) {
  const ShapeSolid ball = make(voxel_shapes::ball(12));
  for (const Sampler sampler : kSamplers) {
    std::set<std::set<Coord>> sets;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const SeedOptions options{.pieces = 10, .seed = seed, .sampler = sampler};
      const std::vector<Seed> seeds = placeSeeds(ball.solid, ball.components, options);
      EXPECT_EQ(seeds, placeSeeds(ball.solid, ball.components, options));
      sets.insert(voxelsOf(seeds));
    }
    EXPECT_EQ(sets.size(), 20u);
  }
}

// The first seeds are those of the parts, in order: what permutes the ids has to be another one for
// each seed, or a part had the same id in every fracture.
TEST_F(Seeds, IdsOfComponentsDifferFromSeedToSeed) {
  std::set<std::vector<int>> orders;
  const ShapeSolid boxes = make(voxel_shapes::solidWhere("boxes apart", 96, [](const Coord& v) {
    return v.x() >= 0 && v.x() < 96 && v.x() % 8 < 4 && v.y() >= 0 && v.y() < 4 && v.z() >= 0 &&
           v.z() < 4;
  }));
  ASSERT_EQ(boxes.components.count(), 12u);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::vector<int> idOfBox(12);
    for (const Seed& s : placeSeeds(boxes.solid, boxes.components, {.pieces = 12, .seed = seed})) {
      idOfBox[static_cast<std::size_t>(s.voxel.x() / 8)] = s.fragment;
    }
    orders.insert(idOfBox);
  }
  EXPECT_EQ(orders.size(), 20u);  // of 12! there are, two are equal once in two million tests
}

// With ids in order of place, the rank correlation of id and coordinate would be near 1.  Without
// any, Spearman's rho has mean 0 and variance 1 / (n - 1), and is close to normal: four standard
// deviations are passed once in 16,000 times, in one of these 12 tests once in 1,300.
TEST_F(Seeds, IdsDoNotFollowThePlace) {
  const ShapeSolid ball = make(voxel_shapes::ball(10));
  constexpr std::size_t n = 400;
  for (const Sampler sampler : kSamplers) {
    const std::vector<Seed> seeds =
        placeSeeds(ball.solid, ball.components,
                   {.pieces = static_cast<int>(n), .seed = 2, .sampler = sampler});
    for (int axis = 0; axis < 3; ++axis) {
      // Ranks of the coordinate, equal ones sharing their mean rank.
      double product = 0.0, squares = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        double rank = 0.5;
        for (const Seed& other : seeds) {
          const int c = other.voxel[axis], own = seeds[i].voxel[axis];
          rank += c < own ? 1.0 : c == own ? 0.5 : 0.0;
        }
        const double fromMiddle = rank - (n + 1) / 2.0;
        product += (seeds[i].fragment - (n + 1) / 2.0) * fromMiddle;
        squares += fromMiddle * fromMiddle;
      }
      const double squaresOfIds = n * (double(n) * n - 1) / 12;
      EXPECT_LT(std::abs(product) / std::sqrt(squares * squaresOfIds), 4 / std::sqrt(n - 1.0));
    }
  }
}

}  // namespace
}  // namespace sherd
