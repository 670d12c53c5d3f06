// Self-affine noise, against its definition: moments and structure function over many points.
#include "mesh/self_affine_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

namespace sherd {
namespace {

constexpr int kSeeds = 40, kPoints = 2000;

// A point far from others: in a cube of a hundred of the longest spacings.
glm::dvec3 anywhere(std::mt19937_64& random) {
  std::uniform_real_distribution<double> side(-50.0, 50.0);
  return {side(random), side(random), side(random)};
}

glm::dvec3 direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

// The rms difference of heights at a distance, over all seeds.
double structure(const SelfAffineShape& shape, double distance) {
  std::mt19937_64 random(1);
  double sum = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const SelfAffineNoise noise(shape, static_cast<std::uint64_t>(seed));
    for (int i = 0; i < kPoints; ++i) {
      const glm::dvec3 a = anywhere(random);
      const double difference = noise.at(a + distance * direction(random)) - noise.at(a);
      sum += difference * difference;
    }
  }
  return std::sqrt(sum / (kSeeds * kPoints));
}

TEST(SelfAffineNoise, HasTheRmsAskedForAndNoMean) {
  const SelfAffineShape shape{.rms = 0.3, .hurst = 0.8, .longest = 1.0, .shortest = 0.05};
  std::mt19937_64 random(2);
  double sum = 0.0, squares = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const SelfAffineNoise noise(shape, static_cast<std::uint64_t>(seed));
    for (int i = 0; i < kPoints; ++i) {
      const double height = noise.at(anywhere(random));
      sum += height, squares += height * height;
    }
  }
  // Of 80,000 points, nearly all of them independent: five standard errors.
  constexpr double kCount = kSeeds * kPoints;
  EXPECT_NEAR(sum / kCount, 0.0, 5.0 * shape.rms / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(squares / kCount), shape.rms, 0.01 * shape.rms);
}

TEST(SelfAffineNoise, DifferencesGrowByTheHurstExponent) {
  for (const double hurst : {0.4, 0.6, 0.8}) {
    const SelfAffineShape shape{.rms = 1.0, .hurst = hurst, .longest = 1.0, .shortest = 1.0 / 512};
    const double slope = std::log(structure(shape, 0.2) / structure(shape, 0.02)) / std::log(10.0);
    EXPECT_NEAR(slope, hurst, 0.03) << hurst;
  }
}

TEST(SelfAffineNoise, IsIndependentBeyondTheLongestSpacing) {
  const SelfAffineShape shape{.rms = 1.0, .hurst = 0.8, .longest = 1.0, .shortest = 0.1};
  EXPECT_NEAR(structure(shape, 2.0), std::sqrt(2.0), 0.03);
}

TEST(SelfAffineNoise, HasNoWavesBelowTheShortest) {
  const SelfAffineShape shape{.rms = 1.0, .hurst = 0.5, .longest = 1.0, .shortest = 0.25};
  // A smooth function: differences are proportional to small distances.
  EXPECT_NEAR(structure(shape, 0.002) / structure(shape, 0.001), 2.0, 0.01);
}

TEST(SelfAffineNoise, IsTheSameFunctionAtEveryScale) {
  const SelfAffineShape shape{.rms = 0.5, .hurst = 0.7, .longest = 1.0, .shortest = 0.1};
  const SelfAffineShape large{.rms = 4.0, .hurst = 0.7, .longest = 8.0, .shortest = 0.8};
  const SelfAffineNoise noise(shape, 3), same(large, 3);
  const glm::dvec3 at{0.3, -1.7, 22.5};
  EXPECT_EQ(same.at(8.0 * at), 8.0 * noise.at(at));
}

TEST(SelfAffineNoise, PrefersNoDirection) {
  const SelfAffineShape shape{.rms = 1.0, .hurst = 0.8, .longest = 1.0, .shortest = 0.1};
  std::mt19937_64 random(4);
  std::vector<double> along;
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::normalize(glm::dvec3(1, 1, 1))}) {
    double sum = 0.0;
    for (int seed = 0; seed < 4 * kSeeds; ++seed) {
      const SelfAffineNoise noise(shape, static_cast<std::uint64_t>(seed));
      for (int i = 0; i < kPoints; ++i) {
        const glm::dvec3 a = anywhere(random);
        const double difference = noise.at(a + 0.3 * axis) - noise.at(a);
        sum += difference * difference;
      }
    }
    along.push_back(sum);
  }
  EXPECT_NEAR(along[0] / along[1], 1.0, 0.03);
}

// Against central differences, whose error is that of a third derivative: of the shortest waves, 1
// long, some hundred times the height, times the squared step.
TEST(SelfAffineNoise, HasTheGradientOfItsValues) {
  const SelfAffineNoise noise({.rms = 2.0, .hurst = 0.6, .longest = 8.0, .shortest = 1.0}, 7);
  constexpr double kStep = 1e-4;
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 at = anywhere(random);
    const SlopedValue sloped = noise.slopedAt(at);
    EXPECT_EQ(sloped.value, noise.at(at));
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 by(0.0);
      by[axis] = kStep;
      const double slope = (noise.at(at + by) - noise.at(at - by)) / (2.0 * kStep);
      EXPECT_NEAR(sloped.gradient[axis], slope, 1e-5);
    }
  }
}

}  // namespace
}  // namespace sherd
