// Fragments with drawn shares: that they are met, and what holds of them as of all.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>

#include "grow/sized/shares.h"
#include "kernels/device_fixture.h"
#include "kernels/grow_reference.h"
#include "seed/draw/sizes.h"
#include "shapes.h"
#include "size_estimators.h"

namespace sherd {
namespace {

class SizedGrowth : public DeviceTest {
 protected:
  static PreparedSolid solidOf(const TriangleMesh& mesh, int resolution) {
    return prepared(voxelize(mesh, {.resolution = resolution}), device());
  }

  static SeededLabels grown(const PreparedSolid& on, int pieces, const ShareOptions& shares,
                            const GrowOptions& grow = {}, std::uint64_t seed = 5) {
    const SeedOptions seeds{.pieces = pieces, .seed = seed};
    return growWithShares(on.solid, on.components, placeSeeds(on.solid, on.components, seeds),
                          device(), {grow, shares, seed});
  }
};

std::vector<double> sharesOf(const Labels& labels) {
  const std::vector<std::uint64_t> counts = countVoxels(labels);
  std::vector<double> shares;
  for (std::size_t id = 1; id < counts.size(); ++id) {
    shares.push_back(static_cast<double>(counts[id]) /
                     static_cast<double>(labels.blocks->insideVoxels()));
  }
  return shares;
}

// The least share that is drawn: 8 voxels more than kAutoShare leaves a fragment, or half of an
// equal share if that is less.
double leastOf(const Labels& labels, double pieces) {
  const auto voxels = static_cast<double>(labels.blocks->insideVoxels());
  return std::min((8.0 + std::min(27.0, std::floor(voxels / (4.0 * pieces)))) / voxels,
                  0.5 / pieces);
}

// Ranked, shares are as close to those drawn as each is to its own.
void expectMet(const Labels& labels, const ShareOptions& options, std::uint64_t seed) {
  std::vector<double> shares = sharesOf(labels);
  std::vector<double> drawn =
      drawnShares(options.sizes, options.sizeParameter, shares.size(),
                  leastOf(labels, static_cast<double>(shares.size())), seed);
  std::sort(shares.begin(), shares.end());
  std::sort(drawn.begin(), drawn.end());
  const double voxel = 1.0 / static_cast<double>(labels.blocks->insideVoxels());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    EXPECT_NEAR(shares[i], drawn[i], std::max(0.0201 * drawn[i], 8.0 * voxel)) << i;
  }
}

constexpr ShareOptions kDistributions[] = {{.sizes = Sizes::uniform},
                                           {.sizes = Sizes::exponential},
                                           {.sizes = Sizes::lognormal, .sizeParameter = 0.8},
                                           {.sizes = Sizes::power, .sizeParameter = 1.6}};

TEST_F(SizedGrowth, MeetsTheDrawnSharesByConnectedFragments) {
  const PreparedSolid cube = solidOf(shapes::cube(1.0), 64);
  for (const ShareOptions& shares : kDistributions) {
    const SeededLabels own = grown(cube, 120, shares);
    expectMet(own.labels, shares, 5);
    EXPECT_EQ(own.labels.fragmentCount, 120);
    EXPECT_EQ(reference::countConnectedComponents(reference::mapOf(own.labels)), 120u);
    EXPECT_EQ(grown(cube, 120, shares).labels.fragment, own.labels.fragment);
  }
}

// Estimators are those that are tested on drawn numbers.
TEST_F(SizedGrowth, ShowsTheParametersThatWereAsked) {
  const PreparedSolid cube = solidOf(shapes::cube(1.0), 64);
  const auto s = estimators::lognormal(sharesOf(grown(cube, 300, kDistributions[2]).labels));
  EXPECT_NEAR(s.value, 0.8, 4.0 * s.standardError);
  const auto tau = estimators::power(sharesOf(grown(cube, 300, kDistributions[3]).labels));
  EXPECT_NEAR(tau.value, 1.6, 4.0 * tau.standardError);
  EXPECT_TRUE(estimators::isExponential(sharesOf(grown(cube, 300, kDistributions[1]).labels)));
  EXPECT_FALSE(estimators::isExponential(sharesOf(grown(cube, 300, {}).labels)));
}

// What sizeError is at most where every fragment has its share, scaled to fill its component,
// within what is tolerated.  The shares of a component add up to another sum than its part of the
// solid, by which they are scaled.  The greatest come first, each to the component with the most
// room that has fragments left.
double mostSizeError(const Labels& labels, const VoxelComponents& components,
                     std::vector<double> drawn) {
  std::vector<std::set<int>> fragments(components.count());
  labels.blocks->forEachInside(
      [&](std::size_t v) { fragments[components.at(v)].insert(labels.fragment[v]); });
  const auto all = static_cast<double>(labels.blocks->insideVoxels());
  std::vector<double> room;
  for (const std::uint64_t voxels : components.voxels()) {
    room.push_back(static_cast<double>(voxels) / all);
  }
  std::vector<std::vector<double>> of(room.size());
  std::sort(drawn.begin(), drawn.end(), std::greater<>());
  for (const double share : drawn) {
    std::size_t best = room.size();
    for (std::size_t c = 0; c < room.size(); ++c) {
      if (of[c].size() == fragments[c].size()) continue;
      if (best == room.size() || room[c] > room[best]) best = c;
    }
    of[best].push_back(share);
    room[best] -= share;
  }
  double most = 0.0;
  for (std::size_t c = 0; c < of.size(); ++c) {
    const double sum = std::accumulate(of[c].begin(), of[c].end(), 0.0);
    const double scale = static_cast<double>(components.voxels()[c]) / all / sum;
    for (const double share : of[c]) {
      const double tolerated = std::max(0.02 * scale * share, 8.0 / all) / share;
      most = std::max(most, std::abs(scale - 1.0) + tolerated);
    }
  }
  return most;
}

// Two cubes of 27 and 8 parts of the volume.
TEST_F(SizedGrowth, FillsEachComponent) {
  const PreparedSolid cubes =
      solidOf(shapes::append(shapes::cube(3.0), shapes::cube(2.0, {4.0, 0.0, 0.0})), 96);
  ASSERT_EQ(cubes.components.count(), 2u);
  for (const int pieces : {30, 2}) {
    for (const ShareOptions& shares : kDistributions) {
      const SeededLabels own = grown(cubes, pieces, shares);
      EXPECT_EQ(reference::countConnectedComponents(reference::mapOf(own.labels)),
                static_cast<std::size_t>(pieces));
      const std::vector<double> drawn =
          drawnShares(shares.sizes, shares.sizeParameter, static_cast<std::size_t>(pieces),
                      leastOf(own.labels, pieces), 5);
      EXPECT_LE(own.sizeError, mostSizeError(own.labels, cubes.components, drawn) + 1e-9)
          << static_cast<int>(shares.sizes) << ' ' << pieces;
    }
  }
}

TEST_F(SizedGrowth, HoldsOnWallsAndWithGrain) {
  const PreparedSolid cup = solidOf(shapes::cup(1.0, 0.1, 1.5, 0.1), 96);
  for (const GrowOptions& grow : {GrowOptions{}, GrowOptions{.growth = Growth::nearest},
                                  GrowOptions{.anisotropy = {{0, 0, 1}, 1.0}}}) {
    const ShareOptions shares{.sizes = Sizes::exponential};
    const SeededLabels own = grown(cup, 25, shares, grow);
    EXPECT_EQ(reference::countConnectedComponents(reference::mapOf(own.labels)), 25u);
    expectMet(own.labels, shares, 5);
  }
}

// Rough cracks lie voxels away from the planes that weights move, more than the smallest fragments
// are wide.
TEST_F(SizedGrowth, ComesWithinATenthWithRoughCracks) {
  const PreparedSolid cup = solidOf(shapes::cup(1.0, 0.1, 1.5, 0.1), 96);
  const SeededLabels own =
      grown(cup, 25, {.sizes = Sizes::exponential}, GrowOptions{.roughness = 1.0});
  EXPECT_EQ(reference::countConnectedComponents(reference::mapOf(own.labels)), 25u);
  EXPECT_LT(own.sizeError, 0.1);
}

TEST_F(SizedGrowth, KeepsTheLeastShare) {
  const PreparedSolid cube = solidOf(shapes::cube(1.0), 48);
  const SeededLabels own =
      grown(cube, 40, {.sizes = Sizes::power, .sizeParameter = 2.0, .minShare = 0.01});
  const std::vector<double> shares = sharesOf(own.labels);
  EXPECT_GE(*std::min_element(shares.begin(), shares.end()), 0.01);
}

TEST_F(SizedGrowth, GivesEveryPieceAVoxelWhereThereAreHardlyMore) {
  const PreparedSolid cube = solidOf(shapes::cube(1.0), 8);
  for (const ShareOptions& shares : kDistributions) {
    for (const int pieces : {1, 2, 300, 512}) {
      const SeededLabels own = grown(cube, pieces, shares);
      EXPECT_EQ(reference::countConnectedComponents(reference::mapOf(own.labels)),
                static_cast<std::size_t>(pieces));
    }
  }
}

TEST_F(SizedGrowth, IsRefusedWhereCellsAreNotVoronois) {
  const PreparedSolid cube = solidOf(shapes::cube(1.0), 16);
  const ShareOptions shares{.sizes = Sizes::uniform};
  for (const GrowOptions& grow :
       {GrowOptions{.growth = Growth::flood}, GrowOptions{.growth = Growth::chain},
        GrowOptions{.growth = Growth::nearest, .metric = Metric::manhattan}}) {
    EXPECT_THROW((void)grown(cube, 4, shares, grow), Error);
  }
}

}  // namespace
}  // namespace sherd
