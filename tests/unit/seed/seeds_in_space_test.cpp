// Seeds are points of space: solids of one mesh at several resolutions have the same.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/fracture.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "kernels/device_fixture.h"
#include "shapes.h"
#include "unit/seed/seeds_fixture.h"

namespace sherd {
namespace {

using SeedsInSpace = DeviceTest;

std::vector<Seed> seedsOf(const PreparedSolid& at, const SeedOptions& options) {
  return placeSeeds(at.solid, at.components, options);
}

PreparedSolid preparedSolid(const TriangleMesh& mesh, int resolution, Device& device,
                            Fill fill = Fill::automatic) {
  return prepared(voxelize(mesh, {.resolution = resolution, .fill = fill}), device);
}

// How far the same seed may lie apart: a point moves by half a step along each axis, and into the
// nearest voxel, at most two away, only where its own is not one of the solid or its surface.
double mostApart(const Solid& coarse) { return (2.0 + std::sqrt(3.0)) * coarse.frame.voxelSize; }

// Expects the same fragments at nearly the same points.  Seeds of which two fall into one voxel are
// drawn anew, so that few seeds, or fine voxels, are needed.
void expectSame(const PreparedSolid& coarse, const PreparedSolid& fine,
                const SeedOptions& options) {
  const std::vector<Seed> a = seedsOf(coarse, options), b = seedsOf(fine, options);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].fragment, b[i].fragment);
    const double away = glm::length(coarse.solid.frame.worldFromIndex(pointOf(a[i])) -
                                    fine.solid.frame.worldFromIndex(pointOf(b[i])));
    EXPECT_LE(away, mostApart(coarse.solid)) << i;
  }
}

TEST_F(SeedsInSpace, OnTheSurfaceAreTheSameToo) {
  const TriangleMesh mesh = shapes::cup(1.0, 0.25, 1.6, 0.25);
  const PreparedSolid coarse = preparedSolid(mesh, 40, device()),
                      fine = preparedSolid(mesh, 97, device());
  for (const Sampler sampler : kSamplers) {
    expectSame(coarse, fine, {.pieces = 20, .seed = 3, .sampler = sampler, .on = SeedsOn::surface});
  }
}

TEST_F(SeedsInSpace, EveryFillDecidesByTheMesh) {
  const TriangleMesh mesh = shapes::hollowBall(1.0, 0.5);
  for (const Fill fill : {Fill::winding, Fill::parity, Fill::flood}) {
    const PreparedSolid coarse = preparedSolid(mesh, 40, device(), fill),
                        fine = preparedSolid(mesh, 97, device(), fill);
    expectSame(coarse, fine, {.pieces = 100, .seed = 1});
    for (const Seed& seed : seedsOf(fine, {.pieces = 100, .seed = 1})) {
      const double r = glm::length(glm::dvec3(fine.solid.frame.worldFromIndex(pointOf(seed))));
      const double slack = 2.0 * fine.solid.frame.voxelSize;
      EXPECT_TRUE(r > 0.5 - slack && r < 1.0 + slack) << r;
    }
  }
  const TriangleMesh sheet = shapes::ball(1.0, 4);
  const auto shell = [&](int resolution) {
    return prepared(
        voxelize(sheet, {.resolution = resolution, .fill = Fill::shell, .shellThickness = 0.2}),
        device());
  };
  expectSame(shell(40), shell(97), {.pieces = 100, .seed = 1});
}

TEST_F(SeedsInSpace, OfShellsAreTheSameAtEveryThicknessAndResolution) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const auto shell = [&](int resolution, double thickness) {
    return prepared(
        voxelize(ball,
                 {.resolution = resolution, .fill = Fill::shell, .shellThickness = thickness}),
        device());
  };
  const SeedOptions plain{.pieces = 12, .seed = 1, .randomImpacts = 1};
  const SeedOptions surface{.pieces = 12, .seed = 1, .on = SeedsOn::surface};
  for (const SeedOptions& options : {plain, surface}) {
    expectSame(shell(64, 0.4), shell(128, 0.4), options);
    expectSame(shell(96, 0.0), shell(800, 0.0), options);
  }
}

TEST_F(SeedsInSpace, AnImpactWiderThanTheBoxIsUniform) {
  const TriangleMesh mesh = shapes::ball(1.0, 4);
  const PreparedSolid coarse = preparedSolid(mesh, 40, device()),
                      fine = preparedSolid(mesh, 97, device());
  const Impact wide{.target = glm::dvec3{0, 0, 2}, .count = 6, .sigma = 50.0};
  expectSame(coarse, fine, {.pieces = 8, .seed = 4, .impacts = {wide}});
}

// Uniform by volume, whatever the resolution: the share in each half of a ball's octants.
TEST_F(SeedsInSpace, AreUniformInTheMesh) {
  const PreparedSolid ball = preparedSolid(shapes::ball(1.0, 5), 24, device());
  std::array<double, 16> hits{};
  constexpr double kInner = 0.7937005259840998;  // the radius of half the volume
  constexpr int kPieces = 50, kSeeds = 400;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    for (const Seed& s : seedsOf(ball, {.pieces = kPieces, .seed = seed})) {
      const glm::dvec3 p = ball.solid.frame.worldFromIndex(pointOf(s));
      ++hits[static_cast<std::size_t>((p.x < 0) * 8 + (p.y < 0) * 4 + (p.z < 0) * 2 +
                                      (glm::length(p) < kInner))];
    }
  }
  double chiSquare = 0.0;
  constexpr double kExpected = 1.0 * kPieces * kSeeds / 16;
  for (const double h : hits) chiSquare += (h - kExpected) * (h - kExpected) / kExpected;
  EXPECT_LT(chiSquare, 37.7);  // of 15 degrees of freedom: passed once in 1,000 times
}

// The centroid of a fragment moves by less than a hundredth of the longest side.
TEST_F(SeedsInSpace, GrowTheSameFragments) {
  for (const TriangleMesh& mesh : {shapes::ball(1.0, 5), shapes::cup(1.0, 0.25, 1.6, 0.25)}) {
    const double longest = 2.0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      const auto fragments = [&](int resolution) {
        return fracture(mesh, {.pieces = 8, .seed = seed, .solid = {.resolution = resolution}},
                        device())
            .fragments;
      };
      const std::vector<Fragment> coarse = fragments(64), fine = fragments(150);
      ASSERT_EQ(coarse.size(), fine.size());
      for (std::size_t i = 0; i < coarse.size(); ++i) {
        EXPECT_LT(glm::length(coarse[i].mass.centroid - fine[i].mass.centroid), 0.01 * longest)
            << seed << ' ' << i;
      }
    }
  }
}

// As many fragments as voxels: points in neighboring voxels take each other's centers otherwise.
TEST_F(SeedsInSpace, EveryFragmentKeepsItsVoxel) {
  const PreparedSolid ball = preparedSolid(shapes::ball(1.0, 4), 14, device());
  const auto voxels = static_cast<int>(ball.solid.voxels);
  for (const int pieces : {voxels / 10, voxels / 2, voxels}) {
    const std::vector<std::vector<Seed>> seeds{seedsOf(ball, {.pieces = pieces, .seed = 2})};
    for (const Metric metric : kMetrics) {
      for (const double strength : {0.0, 4.0, -0.5}) {
        const Labels labels = grow(ball.solid.blocks, seeds, device(),
                                   {.growth = Growth::nearest,
                                    .metric = metric,
                                    .anisotropy = {{1, 2, 3}, strength},
                                    .regrowIsolated = false})
                                  .front();
        const std::vector<std::uint64_t> counts = countVoxels(labels);
        EXPECT_GE(*std::min_element(counts.begin() + 1, counts.end()), 1u);
        for (const Seed& seed : seeds[0]) {
          const std::size_t voxel = voxel_shapes::voxelIndexOf(*ball.solid.blocks, seed.voxel);
          EXPECT_EQ(labels.fragment[voxel], seed.fragment);
        }
      }
    }
  }
}

// Seeds ask whether to stop, wherever in the work.
TEST_F(SeedsInSpace, StopWhenAsked) {
  const PreparedSolid ball = preparedSolid(shapes::ball(1.0, 4), 40, device());
  const SeedOptions impact{.pieces = 90, .impacts = {{.count = 80}}};
  std::vector<SeedOptions> all{impact};
  for (const Sampler sampler : kSamplers) all.push_back({.pieces = 80, .sampler = sampler});
  for (const SeedOptions& options : all) {
    int asked = 0, last = 1 << 30;
    const Progress progress{.report = {}, .cancelled = [&] { return ++asked > last; }};
    (void)placeSeeds(ball.solid, ball.components, options, &progress);
    EXPECT_GE(asked, 80);
    for (const int stop : {0, asked / 2, asked - 1}) {
      asked = 0;
      last = stop;
      try {
        (void)placeSeeds(ball.solid, ball.components, options, &progress);
        ADD_FAILURE() << "not stopped at question " << stop;
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::cancelled);
      }
    }
  }
}

}  // namespace
}  // namespace sherd
