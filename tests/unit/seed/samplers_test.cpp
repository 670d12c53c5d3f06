// How seeds are spread.
#include <gtest/gtest.h>
#include <sherd/seeds.h>

#include <array>
#include <cmath>
#include <numbers>

#include "unit/seed/seeds_fixture.h"

namespace sherd {
namespace {

using openvdb::Coord;

// A cube of voxels that begins at (-half, -half, -half), as its own box.
voxel_shapes::VoxelSolid cube(int half) {
  return voxel_shapes::solidWhere(
      "cube", half, [=](const Coord& v) { return v.x() < half && v.y() < half && v.z() < half; });
}

class Samplers : public DeviceTest {
 protected:
  static ShapeSolid make(voxel_shapes::VoxelSolid shape) { return {std::move(shape), device()}; }
};

// Chi-square of 7 degrees of freedom: passed once in 1,000 times.  (Distinct voxels repel each
// other, which makes the true value smaller, if anything.)
constexpr double kChiSquare7 = 24.32;

double chiSquare(const std::array<double, 8>& hits, const std::array<double, 8>& expected) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 8; ++i) {
    sum += (hits[i] - expected[i]) * (hits[i] - expected[i]) / expected[i];
  }
  return sum;
}

TEST_F(Samplers, UniformIsUniformOverOctants) {
  for (const SeedsOn on : kPlaces) {
    const ShapeSolid solid = make(cube(8));
    std::array<double, 8> hits{};
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      for (const Seed& s :
           placeSeeds(solid.solid, solid.components, {.pieces = 200, .seed = seed, .on = on})) {
        ++hits[static_cast<std::size_t>((s.voxel.x() < 0) * 4 + (s.voxel.y() < 0) * 2 +
                                        (s.voxel.z() < 0))];
      }
    }
    std::array<double, 8> expected{};
    expected.fill(200.0 * 200.0 / 8);
    EXPECT_LT(chiSquare(hits, expected), kChiSquare7);
  }
}

// The largest error of a box's share of points, over boxes with one corner at the cube's own and
// the other at every fourth voxel: the star discrepancy, from below.
double discrepancy(const std::vector<Seed>& seeds, int half) {
  double worst = 0.0;
  const double side = 2.0 * half;
  for (int x = 4; x <= 2 * half; x += 4) {
    for (int y = 4; y <= 2 * half; y += 4) {
      for (int z = 4; z <= 2 * half; z += 4) {
        const auto within = std::count_if(seeds.begin(), seeds.end(), [&](const Seed& s) {
          return s.voxel.x() < x - half && s.voxel.y() < y - half && s.voxel.z() < z - half;
        });
        const double share = static_cast<double>(within) / static_cast<double>(seeds.size());
        worst = std::max(worst, std::abs(share - x * y * z / (side * side * side)));
      }
    }
  }
  return worst;
}

TEST_F(Samplers, HaltonIsMoreEvenThanUniform) {
  constexpr int kHalf = 16;
  const ShapeSolid solid = make(cube(kHalf));
  double halton = 0.0, uniform = 0.0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SeedOptions options{.pieces = 500, .seed = seed, .sampler = Sampler::halton};
    halton += discrepancy(placeSeeds(solid.solid, solid.components, options), kHalf);
    options.sampler = Sampler::uniform;
    uniform += discrepancy(placeSeeds(solid.solid, solid.components, options), kHalf);
  }
  EXPECT_LT(halton, uniform);
}

// 2^k successive numbers of the base 2 inverse lie one in each of 2^k intervals, however their
// digits are permuted; the same along y with 27 and along z with 25 intervals.  One seed more
// than intervals is drawn.
TEST_F(Samplers, HaltonHasOnePointInEachInterval) {
  constexpr std::array<int, 3> kSides{32, 27, 25};
  const ShapeSolid solid = make(voxel_shapes::solidWhere("box", 32, [&](const Coord& v) {
    return v.x() >= 0 && v.y() >= 0 && v.z() >= 0 && v.x() < 32 && v.y() < 27 && v.z() < 25;
  }));
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (int axis = 0; axis < 3; ++axis) {
      const int side = kSides[static_cast<std::size_t>(axis)];
      std::set<int> places;
      for (const Seed& s :
           placeSeeds(solid.solid, solid.components,
                      {.pieces = side + 1, .seed = seed, .sampler = Sampler::halton})) {
        places.insert(s.voxel[axis]);
      }
      EXPECT_EQ(places.size(), static_cast<std::size_t>(side));
    }
  }
}

// P(sum of 12 uniforms < t), Irwin and Hall.
double sumOfTwelveBelow(double t) {
  double sum = 0.0, binomial = 1.0;
  for (int k = 0; k <= 12 && k < t; ++k) {
    sum += (k % 2 ? -1 : 1) * binomial * std::pow(t - k, 12);
    binomial *= (12.0 - k) / (k + 1);
  }
  return sum / std::tgamma(13.0);
}

// Along each axis a seed's place is normal (as 12 uniforms are) about the middle with a quarter of
// the side as standard deviation, given that it lies within.  (A seed that meets a taken voxel is
// drawn anew.  On average 25 are taken of 110,592, where the density squared integrates to 1.9: 4
// seeds in 10,000, far below the 3 % that 1,250 seeds in an eighth resolve.)
TEST_F(Samplers, GaussianIsNormalAboutTheMiddle) {
  constexpr int kHalf = 24, kPieces = 50, kSeeds = 200;
  const ShapeSolid solid = make(cube(kHalf));
  std::array<double, 8> share{};  // of each eighth of the side
  const auto below = [](double fraction) { return sumOfTwelveBelow(6 + (fraction - 0.5) / 0.25); };
  for (std::size_t i = 0; i < 8; ++i) {
    const double low = static_cast<double>(i) / 8, high = static_cast<double>(i + 1) / 8;
    const double normal = (below(high) - below(low)) / (below(1) - below(0));
    share[i] = normal;
  }
  std::array<std::array<double, 8>, 3> hits{};
  std::array<double, 3> sum{}, squares{};
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    for (const Seed& s :
         placeSeeds(solid.solid, solid.components,
                    {.pieces = kPieces, .seed = seed, .sampler = Sampler::gaussian})) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double fromMiddle = (s.voxel[axis] + 0.5) / (2 * kHalf);
        ++hits[a][static_cast<std::size_t>((fromMiddle + 0.5) * 8)];
        sum[a] += fromMiddle;
        squares[a] += fromMiddle * fromMiddle;
      }
    }
  }
  constexpr double n = kPieces * kSeeds;
  std::array<double, 8> expected{};
  for (std::size_t i = 0; i < 8; ++i) expected[i] = n * share[i];
  // Moments of the place over the side, voxel by voxel.
  double variance = 0.0, fourth = 0.0;
  for (int v = 0; v < 2 * kHalf; ++v) {
    const double low = v / (2.0 * kHalf), high = (v + 1) / (2.0 * kHalf);
    const double normal = (below(high) - below(low)) / (below(1) - below(0));
    const double p = normal;
    const double fromMiddle = (low + high) / 2 - 0.5;
    variance += p * fromMiddle * fromMiddle;
    fourth += p * std::pow(fromMiddle, 4);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_LT(chiSquare(hits[axis], expected), kChiSquare7) << "axis " << axis;
    // Four standard deviations: passed once in 16,000 times.
    EXPECT_LT(std::abs(sum[axis] / n), 4 * std::sqrt(variance / n));
    EXPECT_LT(std::abs(squares[axis] / n - variance),
              4 * std::sqrt((fourth - variance * variance) / n));
  }
}

double leastDistance(const std::vector<Seed>& seeds) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      least = std::min(least, apart(Metric::euclidean, seeds[i], seeds[k]));
    }
  }
  return least;
}

// The distance shrinks only after 100 misses in a row.  Were a tenth of the solid still farther
// than it from all seeds, that would happen once in 38,000 times.  So when it last shrank, n balls
// of the radius before covered nine tenths of the voxels, and its square shrank by a sixteenth.  A
// seed's point is rounded by 1/128 voxel along each axis.
double leastDistanceFor(std::uint64_t voxels, std::uint64_t seeds) {
  const double ball = 0.9 * static_cast<double>(voxels) / static_cast<double>(seeds);
  const double radius = std::cbrt(ball / (4.0 / 3.0 * std::numbers::pi));
  return radius * std::sqrt(15.0 / 16.0) - 3.0 / 64;
}

TEST_F(Samplers, PoissonKeepsSeedsApart) {
  for (const voxel_shapes::VoxelSolid& shape : {voxel_shapes::ball(19), voxel_shapes::cup(20, 3)}) {
    const ShapeSolid solid = make(shape);
    for (const int pieces : {10, 100, 500}) {
      SeedOptions options{.pieces = pieces, .seed = 5, .sampler = Sampler::poisson};
      const double least = leastDistance(placeSeeds(solid.solid, solid.components, options));
      EXPECT_GE(least, leastDistanceFor(solid.solid.voxels, static_cast<std::uint64_t>(pieces)));
      options.sampler = Sampler::uniform;
      EXPECT_GT(least, leastDistance(placeSeeds(solid.solid, solid.components, options)));
      // On the surface, and with seeds that shape.
      options.sampler = Sampler::poisson;
      options.on = SeedsOn::surface;
      options.extraSeeds = pieces / 2;
      const double more = leastDistance(placeSeeds(solid.solid, solid.components, options));
      options.sampler = Sampler::uniform;
      EXPECT_GT(more, leastDistance(placeSeeds(solid.solid, solid.components, options)));
    }
  }
}

}  // namespace
}  // namespace sherd
