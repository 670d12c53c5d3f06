// Impacts: how their seeds scatter.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <cmath>
#include <limits>

#include "unit/seed/seeds_fixture.h"

namespace sherd {
namespace {

using openvdb::Coord;

class Impacts : public DeviceTest {
 protected:
  static ShapeSolid make(voxel_shapes::VoxelSolid shape) { return {std::move(shape), device()}; }
};

std::string refusal(const ShapeSolid& on, const SeedOptions& options) {
  try {
    (void)placeSeeds(on.solid, on.components, options);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::usage);
    return e.what();
  }
  return "";
}

int within(const std::vector<Seed>& seeds, const Coord& center, int chebyshev) {
  return static_cast<int>(std::count_if(seeds.begin(), seeds.end(), [&](const Seed& s) {
    return metricOrder(Metric::chebyshev, s.voxel, center) <= chebyshev;
  }));
}

// A sum of 12 uniforms stays within six standard deviations: 12 voxels here, and half a voxel of
// rounding.  One more seed is the part's own, anywhere.
TEST_F(Impacts, MakeAsManyFragmentsAsTheyAreAskedFor) {
  const ShapeSolid ball = make(voxel_shapes::ball(25));
  const SeedOptions options{
      .pieces = 43,
      .seed = 6,
      .impacts = {{.target = glm::dvec3{40, 0, 0}, .count = 30, .sigma = 2.0},
                  {.target = glm::dvec3{-26, 0, 0}, .count = 12, .sigma = 2.0}}};
  const std::vector<Seed> seeds = placeSeeds(ball.solid, ball.components, options);
  expectPromises(ball, seeds, 43, 0, options);
  const int right = within(seeds, {25, 0, 0}, 12), left = within(seeds, {-25, 0, 0}, 12);
  EXPECT_GE(right, 30);
  EXPECT_GE(left, 12);
  EXPECT_LE(right + left, 43);
}

// Without a permutation the seeds of an impact would have the lowest ids.  The sum of k ids of n
// drawn at random has mean k (n + 1) / 2 and variance k (n - k) (n + 1) / 12 (Wilcoxon), and is
// close to normal: four standard deviations are passed once in 16,000 times.
TEST_F(Impacts, CannotBeToldByTheIds) {
  const ShapeSolid ball = make(voxel_shapes::ball(25));
  const Coord pole(25, 0, 0);
  const std::vector<Seed> seeds =
      placeSeeds(ball.solid, ball.components,
                 {.pieces = 61,
                  .seed = 4,
                  .impacts = {{.target = glm::dvec3{25, 0, 0}, .count = 30, .sigma = 2.0}}});
  const double k = within(seeds, pole, 12), n = 61;
  double sum = 0.0;
  for (const Seed& s : seeds) sum += within({s}, pole, 12) ? s.fragment : 0;
  EXPECT_LT(std::abs(sum - k * (n + 1) / 2), 4 * std::sqrt(k * (n - k) * (n + 1) / 12));
}

TEST_F(Impacts, ShareHalfOfThePiecesUnlessToldOtherwise) {
  const ShapeSolid ball = make(voxel_shapes::ball(12));
  const SeedOptions options{.pieces = 21, .impacts = {{.merge = true}}, .randomImpacts = 1};
  // (21 - 1) / 2 / 2: five new fragments of the 21, and five seeds that merge.
  expectPromises(ball, placeSeeds(ball.solid, ball.components, options), 21, 5, options);
}

TEST_F(Impacts, MergeIntoTheNearestFragment) {
  for (const voxel_shapes::VoxelSolid& shape :
       {voxel_shapes::ball(12), voxel_shapes::manyComponentsWithin(9)}) {
    const ShapeSolid on = make(shape);
    const int pieces = static_cast<int>(on.components.count()) + 30;
    for (const Metric metric : kMetrics) {
      for (const SeedsOn place : kPlaces) {
        const SeedOptions options{
            .pieces = pieces,
            .seed = 8,
            .on = place,
            .extraSeeds = 40,
            .mergeMetric = metric,
            .impacts = {{.target = glm::dvec3{0, 40, 3}, .count = 20, .sigma = 1.5, .merge = true},
                        {.count = 20}}};
        expectPromises(on, placeSeeds(on.solid, on.components, options),
                       static_cast<std::size_t>(pieces), 60, options);
      }
    }
  }
}

// Draws of variance s^2 and excess kurtosis k give a sample variance with standard deviation
// s^2 sqrt((2 + k) / n); a sum of m uniforms has k = -6 / (5 m).  Rounding to voxels adds 1/12 to
// the variance.  Only the axes along the face that is struck, which no draw leaves: 6 * 5 voxels,
// or half the side.  (Distinct voxels push seeds apart: 10 seeds in some (4 pi)^1.5 s^3 / 2 > 2,700
// voxels meet once in 600 draws, far below the tolerance of 6 %.)
TEST_F(Impacts, ScatterWithTheDeviationAskedFor) {
  constexpr int kHalf = 32, kSeeds = 400, kCount = 10;
  const ShapeSolid cube = make(voxel_shapes::solidWhere("cube", kHalf, [](const Coord& v) {
    return v.z() > -16;  // flat, to be quicker
  }));
  const double h = 0.25;
  Solid solid = cube.solid;
  solid.frame = {{3.0, -1.0, 2.0}, h};
  for (const bool byBias : {true, false}) {
    const double side = 2 * kHalf + 1;
    const double deviation = byBias ? side / std::sqrt(12.0 * 5) : 5.0;  // voxels
    const double kurtosis = -6.0 / (5 * (byBias ? 5 : 12));
    Impact impact{.target = solid.frame.worldFromIndex(glm::dvec3(0.2, -0.3, kHalf + 3.0)),
                  .count = kCount,
                  .sigma = byBias ? 0.0 : deviation * h,
                  .bias = 5,
                  .merge = true};
    double sum = 0.0, squares = 0.0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      const std::vector<Seed> seeds =
          placeSeeds(solid, cube.components, {.pieces = 1, .seed = seed, .impacts = {impact}});
      ASSERT_EQ(seeds.size(), 1u + kCount);
      for (std::size_t i = 1; i < seeds.size(); ++i) {
        for (const int c : {seeds[i].voxel.x(), seeds[i].voxel.y()}) {
          sum += c;
          squares += c * c;
        }
      }
    }
    constexpr double n = 2.0 * kSeeds * kCount;
    const double variance = deviation * deviation + 1.0 / 12;
    EXPECT_LT(std::abs(sum / n), 4 * std::sqrt(variance / n));  // passed once in 16,000 times
    EXPECT_LT(std::abs(squares / n - variance), 4 * variance * std::sqrt((2 + kurtosis) / n));
  }
}

TEST_F(Impacts, WidenWhereTheNeighborhoodIsFull) {
  const ShapeSolid ball = make(voxel_shapes::ball(8));
  const int all = static_cast<int>(ball.solid.voxels);
  for (const double sigma : {1e-12, 0.3, 3.0, 1e12}) {
    for (const int count : {1, 20, all / 2, all - 1}) {
      const SeedOptions options{
          .pieces = count + 1,
          .seed = 1,
          .impacts = {{.target = glm::dvec3{0, 0, 9}, .count = count, .sigma = sigma}}};
      expectPromises(ball, placeSeeds(ball.solid, ball.components, options),
                     static_cast<std::size_t>(count) + 1, 0, options);
    }
  }
}

TEST_F(Impacts, StayInTheComponentThatIsHit) {
  // Plates with a gap of one voxel: most draws fall into the other.
  const ShapeSolid plates = make(voxel_shapes::solidWhere(
      "plates", 12, [](const Coord& v) { return v.z() == 0 || v.z() == 2; }));
  ASSERT_EQ(plates.components.count(), 2u);
  for (const int count : {10, 400, 624}) {
    const SeedOptions options{.pieces = 2,
                              .impacts = {{.target = Ray{{1.2, 2.1, 50}, {0, 0, -1}},
                                           .count = count,
                                           .sigma = 6.0,
                                           .merge = true}}};
    const std::vector<Seed> seeds = placeSeeds(plates.solid, plates.components, options);
    expectPromises(plates, seeds, 2, static_cast<std::size_t>(count), options);
    for (std::size_t i = 2; i < seeds.size(); ++i) EXPECT_EQ(seeds[i].voxel.z(), 2);
  }
  EXPECT_NE(refusal(plates, {.pieces = 2, .impacts = {{.count = 625, .merge = true}}})
                .find("with 624 free voxels"),
            std::string::npos);
}

TEST_F(Impacts, MoveAndScaleWithTheSolid) {
  const ShapeSolid ball = make(voxel_shapes::ball(10));
  Solid moved = ball.solid;
  moved.frame = {{64, -8, 16}, 4.0};
  const auto seedsOf = [&](const Solid& solid, double scale, const glm::dvec3& offset) {
    return placeSeeds(
        solid, ball.components,
        {.pieces = 30,
         .seed = 2,
         .impacts = {
             {.target = scale * glm::dvec3(3, 9, 4) + offset, .count = 9, .sigma = 2.5 * scale},
             {.target = Ray{scale * glm::dvec3(-30, 2, 1) + offset, {3, 0.1, 0.2}}}}});
  };
  EXPECT_EQ(seedsOf(ball.solid, 1.0, glm::dvec3(0)), seedsOf(moved, 4.0, {64, -8, 16}));
}

TEST_F(Impacts, RefuseWhatCannotBe) {
  const ShapeSolid ball = make(voxel_shapes::ball(6));
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  const auto refused = [&](const Impact& impact, int pieces = 8) {
    return refusal(ball, {.pieces = pieces, .impacts = {impact}});
  };
  EXPECT_NE(refused({.count = 9}).find("try more pieces"), std::string::npos);
  EXPECT_EQ(refused({.count = 8}), "");  // with the one that the component has besides
  EXPECT_NE(refused({.target = Ray{{0, 0, 20}, {0, 0, 1}}}).find("misses"), std::string::npos);
  EXPECT_NE(refused({.target = Ray{{0, 0, 20}, {0, 0, 0}}}), "");
  EXPECT_NE(refused({.target = Ray{{0, 0, 20}, {0, nan, 0}}}), "");
  EXPECT_NE(refused({.target = Ray{{infinite, 0, 20}, {0, 1, 0}}}), "");
  EXPECT_NE(refused({.target = glm::dvec3{nan, 0, 0}}), "");
  EXPECT_NE(refused({.count = -1}), "");
  EXPECT_NE(refused({.sigma = -1.0}), "");
  EXPECT_NE(refused({.sigma = infinite}), "");
  EXPECT_NE(refused({.bias = 0}), "");
  EXPECT_NE(refused({.bias = kMaxBias + 1}), "");
  EXPECT_NE(refused({.count = 2'000'000'000, .merge = true}), "");
  // Whatever is finite is a place.
  EXPECT_EQ(refused({.target = glm::dvec3{1e300, -1e300, 0}}), "");
  EXPECT_EQ(refused({.bias = kMaxBias}), "");
}

}  // namespace
}  // namespace sherd
