// Shares and planes of splits against what they mean.
#include "grow/sized/split_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>

#include "grow/splits/split_wall.h"

namespace sherd {
namespace {

double sumOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(SplitPlan, SharesAddUpToOne) {
  for (const std::size_t pieces : {1, 2, 9, 500, 65534}) {
    const std::vector<double> shares = sharesOfSplits({}, pieces, 3);
    ASSERT_EQ(shares.size(), pieces);
    EXPECT_NEAR(sumOf(shares), 1.0, 1e-9);
    EXPECT_GT(*std::min_element(shares.begin(), shares.end()), 0.0);
  }
}

// With a high power the largest piece is always next: halves of halves.
TEST(SplitPlan, AHighPowerSplitsTheLargest) {
  const std::vector<double> shares = sharesOfSplits({.power = 10.0, .offset = 0.0}, 64, 5);
  for (const double share : shares) {
    EXPECT_GE(share, 1.0 / 128.0 - 1e-12);
    EXPECT_LE(share, 1.0 / 32.0 + 1e-12);
  }
}

// With power 0 every piece is as likely: sizes spread over many orders.
TEST(SplitPlan, APowerOfZeroSpreadsSizes) {
  const std::vector<double> shares = sharesOfSplits({.power = 0.0, .offset = 0.0}, 1024, 5);
  EXPECT_GT(*std::max_element(shares.begin(), shares.end()) /
                *std::min_element(shares.begin(), shares.end()),
            100.0);
}

TEST(SplitPlan, SharesAreRaisedToTheLeast) {
  const std::vector<double> raised = raisedTo(0.1, {0.01, 0.19, 0.3, 0.5});
  EXPECT_NEAR(sumOf(raised), 1.0, 1e-12);
  for (const double share : raised) EXPECT_GE(share, 0.1);
  for (const double share : raisedTo(0.25, {0.0, 0.0, 0.0, 1.0})) EXPECT_NEAR(share, 0.25, 1e-12);
}

TEST(SplitPlan, TheFirstSharesAddUpToNearestToAFraction) {
  const std::vector<double> shares{0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(firstOf(shares, 0.5), 3u);  // 0.6, not 0.3
  EXPECT_EQ(firstOf(shares, 0.32), 2u);
  EXPECT_EQ(firstOf(shares, 0.0), 1u);
  EXPECT_EQ(firstOf(shares, 1.0), 3u);  // at least one is left
}

TEST(SplitPlan, ComponentsGetSharesByTheirSize) {
  const std::vector<std::uint64_t> voxels{700, 27, 273};
  const std::vector<double> shares(10, 0.1);
  const auto given = sharesOfComponents(shares, std::vector<double>{700, 27, 273}, voxels);
  EXPECT_EQ(given[0].size(), 7u);
  EXPECT_EQ(given[1].size(), 1u);  // though a third of a share is missing
  EXPECT_EQ(given[2].size(), 2u);
  const std::vector<std::uint64_t> two{2, 50};
  const auto full =
      sharesOfComponents(std::vector<double>(52, 1.0 / 52.0), std::vector<double>{2, 50}, two);
  EXPECT_EQ(full[0].size(), 2u);
  EXPECT_EQ(full[1].size(), 50u);
  const auto least =
      sharesOfComponents(std::vector<double>(3, 1.0 / 3.0), std::vector<double>{1, 1, 98}, voxels);
  for (const auto& each : least) EXPECT_EQ(each.size(), 1u);
}

// The same by its definition: each share, the greatest first, goes to the component that lacks the
// most of its mass, the first of equal ones, unless it is full, or others are empty and there is
// only a share left for each of them.
std::vector<std::vector<double>> sharesByDefinition(std::vector<double> shares,
                                                    const std::vector<double>& mass,
                                                    const std::vector<std::uint64_t>& voxels) {
  std::vector<std::vector<double>> all(mass.size());
  const double total = sumOf(mass);
  std::vector<double> lacking;
  for (const double each : mass) lacking.push_back(each / total);
  std::sort(shares.begin(), shares.end(), std::greater<>());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const auto empty = static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [](const auto& own) { return own.empty(); }));
    std::size_t best = all.size();
    for (std::size_t c = 0; c < all.size(); ++c) {
      const bool mayGet = all[c].empty() || shares.size() - i > empty;
      if (!mayGet || all[c].size() == voxels[c]) continue;
      if (best == all.size() || lacking[c] > lacking[best]) best = c;
    }
    all[best].push_back(shares[i]);
    lacking[best] -= shares[i];
  }
  return all;
}

TEST(SplitPlan, ComponentsGetSharesAsDefined) {
  std::mt19937 random(7);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  for (int run = 0; run < 500; ++run) {
    std::vector<std::uint64_t> voxels(2 + below(12));
    for (std::uint64_t& each : voxels) each = 1 + below(run % 2 == 0 ? 3 : 40);  // with ties
    const std::vector<double> mass(voxels.begin(), voxels.end());
    const auto all = static_cast<std::size_t>(sumOf(mass));
    const std::size_t pieces = voxels.size() + below(all - voxels.size() + 1);
    std::vector<double> shares(pieces);
    for (double& share : shares) share = static_cast<double>(1 + below(run % 3 == 0 ? 1 : 9));
    const double sum = sumOf(shares);
    for (double& share : shares) share /= sum;
    EXPECT_EQ(sharesOfComponents(shares, mass, voxels), sharesByDefinition(shares, mass, voxels))
        << run;
  }
}

TEST(SplitPlan, ManyComponentsGetSharesInLittleTime) {
  const std::vector<std::uint64_t> voxels(60000, 2);
  const auto given = sharesOfComponents(std::vector<double>(65534, 1.0 / 65534.0),
                                        std::vector<double>(60000, 2.0), voxels);
  std::size_t twice = 0;
  for (const auto& each : given) twice += each.size() - 1;
  EXPECT_EQ(twice, 5534u);
}

VoxelSums sumsOfBox(const glm::ivec3& size) {
  VoxelSums sums;
  for (int x = 0; x < size.x; ++x) {
    for (int y = 0; y < size.y; ++y) {
      for (int z = 0; z < size.z; ++z) {
        VoxelSums one;
        one.count = 1;
        sums.add(one, {x - 100, y + 7, z});
      }
    }
  }
  return sums;
}

// Of a box of n voxels the variance along an axis is (n^2 - 1) / 12, and that of the box n^2 / 12.
TEST(SplitPlan, SumsOfABoxHaveItsVariance) {
  const VoxelSums sums = sumsOfBox({8, 3, 20});
  EXPECT_EQ(sums.count, 480);
  const glm::dvec3 mean = sums.mean();
  EXPECT_DOUBLE_EQ(mean.x, -96.5);
  EXPECT_DOUBLE_EQ(mean.y, 8.0);
  EXPECT_DOUBLE_EQ(mean.z, 9.5);
  const glm::dmat3 covariance = sums.covariance();
  EXPECT_NEAR(covariance[0][0], 64.0 / 12.0, 1e-9);
  EXPECT_NEAR(covariance[1][1], 9.0 / 12.0, 1e-9);
  EXPECT_NEAR(covariance[2][2], 400.0 / 12.0, 1e-9);
  EXPECT_NEAR(covariance[1][0], 0.0, 1e-9);
  EXPECT_NEAR(covariance[2][1], 0.0, 1e-9);
}

double degreesFrom(const glm::dvec3& normal, const glm::dvec3& axis) {
  const double cosine = std::abs(glm::dot(glm::normalize(normal), axis));
  return std::acos(std::min(cosine, 1.0)) * 180.0 / M_PI;
}

TEST(SplitPlan, CracksGoAcrossTheLongAxis) {
  const glm::dmat3 covariance = sumsOfBox({10, 10, 30}).covariance();
  double sum = 0.0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    EXPECT_LT(degreesFrom(crackNormal(covariance, {.tilt = 0.0}, {}, 1, i), {0, 0, 1}), 1.0);
    const double angle = degreesFrom(crackNormal(covariance, {.tilt = 10.0}, {}, 1, i), {0, 0, 1});
    sum += angle * angle;
  }
  // The angle has two parts of this deviation; the tangent of 10 degrees is 1 % above the angle.
  EXPECT_NEAR(std::sqrt(sum / 800.0), 10.0, 1.0);
}

TEST(SplitPlan, CracksOfACubeHaveEveryDirection) {
  const glm::dmat3 covariance = sumsOfBox({20, 20, 20}).covariance();
  glm::dmat3 mean(0.0);
  constexpr int kDraws = 3000;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const glm::dvec3 n = glm::normalize(crackNormal(covariance, {}, {}, 1, i));
    mean += glm::outerProduct(n, n) / static_cast<double>(kDraws);
  }
  // Of isotropic directions the mean of n n^T is 1/3 of the identity; the standard error of an
  // element is sqrt(4/45 / draws).
  const double error = std::sqrt(4.0 / 45.0 / kDraws);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(mean[i][j], i == j ? 1.0 / 3.0 : 0.0, 4.0 * error);
  }
}

// A grain of strength 9 divides lengths along it by 10: a box twice as long as wide is a plate,
// whose cracks go along the grain.
TEST(SplitPlan, GrainShortensThePiece) {
  const glm::dmat3 covariance = sumsOfBox({10, 10, 20}).covariance();
  const Anisotropy grain{{0.0, 0.0, 2.0}, 9.0};
  for (std::uint64_t i = 0; i < 50; ++i) {
    EXPECT_GT(degreesFrom(crackNormal(covariance, {.tilt = 0.0}, grain, 1, i), {0, 0, 1}), 80.0);
  }
}

TEST(SplitPlan, QuantilesOfEvenVoxelsAreTheirPositions) {
  ProjectedVoxels projected(50.0, 100.0 / std::sqrt(12.0));
  for (int i = 0; i < 100; ++i) {
    projected.add(i + 0.5, 1.0 / std::sqrt(12.0), 1.0);
  }
  for (const double fraction : {0.05, 0.25, 0.5, 0.9}) {
    EXPECT_NEAR(projected.quantile(fraction), 100.0 * fraction, 0.6);  // a bin is 0.56
  }
}

glm::dmat3 covarianceOfBox(const glm::dvec3& size) {
  glm::dmat3 covariance(0.0);
  for (int i = 0; i < 3; ++i) covariance[i][i] = size[i] * size[i] / 12.0;
  return covariance;
}

glm::dmat3 diagonal(double x, double y, double z) {
  return {glm::dvec3(x, 0.0, 0.0), glm::dvec3(0.0, y, 0.0), glm::dvec3(0.0, 0.0, z)};
}

TEST(SplitWall, CracksCrossAPlateAtRightAngles) {
  const glm::dvec3 normal(std::cos(10.0 * M_PI / 180.0), 0.0, std::sin(10.0 * M_PI / 180.0));
  // Of a wall of 4 voxels half of the voxels are at the surface.
  const CrackedLeaves leaves{1000.0, diagonal(0.0, 0.0, 500.0)};
  const glm::dvec3 rotated = acrossWalls(leaves, covarianceOfBox({100.0, 100.0, 4.0}), normal);
  EXPECT_NEAR(std::tan(degreesFrom(rotated, {1, 0, 0}) * M_PI / 180.0),
              std::tan(10.0 * M_PI / 180.0) / 9.0, 1e-9);
}

TEST(SplitWall, CracksCrossATubeAcrossItsAxis) {
  const glm::dvec3 normal(0.5, 0.0, std::sqrt(0.75));
  const CrackedLeaves leaves{1000.0, diagonal(250.0, 250.0, 0.0)};
  const glm::dvec3 rotated = acrossWalls(leaves, covarianceOfBox({100.0, 100.0, 200.0}), normal);
  EXPECT_NEAR(std::tan(degreesFrom(rotated, {0, 0, 1}) * M_PI / 180.0),
              std::tan(30.0 * M_PI / 180.0) / 5.0, 1e-9);
}

TEST(SplitWall, CracksOfABlockStay) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.8, 0.0, 0.6));
  // A section of 100 x 100 voxels has 400 at its border.
  const CrackedLeaves leaves{10000.0, diagonal(200.0, 200.0, 0.0)};
  EXPECT_EQ(acrossWalls(leaves, covarianceOfBox({100.0, 100.0, 100.0}), normal), normal);
  EXPECT_EQ(acrossWalls({}, covarianceOfBox({100.0, 100.0, 100.0}), normal), normal);
}

}  // namespace
}  // namespace sherd
