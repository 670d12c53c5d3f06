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
#include "unit/seeds_fixture.h"

namespace sherd {
namespace {

using SeedsInSpace = DeviceTest;

std::vector<Seed> seedsOf(const PreparedSolid& at, const SeedOptions& options) {
  return placeSeeds(at.solid, at.components, options);
}

PreparedSolid solidOf(const TriangleMesh& mesh, int resolution, Device& device,
                      Fill fill = Fill::automatic) {
  return prepared(voxelize(mesh, {.resolution = resolution, .fill = fill}), device);
}

// How far the same seed may lie apart: a point moves by half a step along each axis, and into the
// nearest voxel, at most two away, only where its own is not one of the solid or its surface.
double mostApart(const Solid& coarse) { return (2.0 + std::sqrt(3.0)) * coarse.frame.voxelSize; }

// Expects the same fragments at nearly the same points; returns the number of those that did not
// move into another voxel, so that only rounding to steps of both solids is between them.
std::size_t expectSame(const PreparedSolid& coarse, const PreparedSolid& fine,
                       const SeedOptions& options) {
  const std::vector<Seed> a = seedsOf(coarse, options), b = seedsOf(fine, options);
  EXPECT_EQ(a.size(), b.size());
  if (a.size() != b.size()) return 0;
  const double rounding = std::sqrt(3.0) / 128 * 2.0 * coarse.solid.frame.voxelSize;
  std::size_t exact = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].fragment, b[i].fragment);
    const double away = glm::length(coarse.solid.frame.worldFromIndex(pointOf(a[i])) -
                                    fine.solid.frame.worldFromIndex(pointOf(b[i])));
    EXPECT_LE(away, mostApart(coarse.solid)) << i;
    exact += away <= rounding ? 1 : 0;
  }
  return exact;
}

TEST_F(SeedsInSpace, AreTheSameAtAnyResolution) {
  const TriangleMesh overlapping =
      shapes::append(shapes::ball(1.0, 4), shapes::ball(0.8, 4, {1.1, 0.2, 0.0}));
  for (const TriangleMesh& mesh :
       {shapes::ball(1.0, 5), shapes::cup(1.0, 0.25, 1.6, 0.25), shapes::torus(1.0, 0.4),
        shapes::hollowBall(1.0, 0.6), overlapping}) {
    const PreparedSolid coarse = solidOf(mesh, 40, device()), fine = solidOf(mesh, 97, device());
    for (const Sampler sampler : kSamplers) {
      for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const SeedOptions options{
            .pieces = 12,
            .seed = seed,
            .sampler = sampler,
            .extraSeeds = 24,
            .impacts = {{.target = glm::dvec3{0.1, 0.2, 3.0}, .count = 4, .sigma = 0.2}},
            .randomImpacts = 1};
        expectSame(coarse, fine, options);
      }
    }
  }
}

// A seed moves into another voxel only if its own voxel's center is outside, so at most half the
// diagonal of a voxel from the surface.  That is a layer of this share of the volume, to first
// order; four standard deviations are passed once in 30,000 times.
TEST_F(SeedsInSpace, KeepTheirPointsAwayFromTheSurface) {
  constexpr int kPieces = 400;
  for (const TriangleMesh& mesh : {shapes::ball(1.0, 5), shapes::cup(1.0, 0.25, 1.6, 0.25),
                                   shapes::torus(1.0, 0.4), shapes::hollowBall(1.0, 0.6)}) {
    const PreparedSolid coarse = solidOf(mesh, 60, device()), fine = solidOf(mesh, 97, device());
    const double layer = std::sqrt(3.0) / 2 * (coarse.solid.frame.voxelSize);
    const double share = layer * area(mesh) / volume(mesh);
    const double moved =
        kPieces - static_cast<double>(expectSame(coarse, fine, {.pieces = kPieces, .seed = 6}));
    EXPECT_LT(moved, kPieces * share + 4 * std::sqrt(kPieces * share * (1 - share)));
  }
}

TEST_F(SeedsInSpace, OnTheSurfaceAreTheSameToo) {
  const TriangleMesh mesh = shapes::cup(1.0, 0.25, 1.6, 0.25);
  const PreparedSolid coarse = solidOf(mesh, 40, device()), fine = solidOf(mesh, 97, device());
  for (const Sampler sampler : kSamplers) {
    expectSame(coarse, fine, {.pieces = 20, .seed = 3, .sampler = sampler, .on = SeedsOn::surface});
  }
}

TEST_F(SeedsInSpace, EveryFillDecidesByTheMesh) {
  const TriangleMesh mesh = shapes::hollowBall(1.0, 0.5);
  for (const Fill fill : {Fill::winding, Fill::parity, Fill::flood}) {
    const PreparedSolid coarse = solidOf(mesh, 40, device(), fill),
                        fine = solidOf(mesh, 97, device(), fill);
    expectSame(coarse, fine, {.pieces = 100, .seed = 1});
    for (const Seed& seed : seedsOf(fine, {.pieces = 100, .seed = 1})) {
      const double r = glm::length(fine.solid.frame.worldFromIndex(pointOf(seed)));
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

// A plate with fins that only the finer voxels resolve: a seed that falls into one is drawn anew,
// and moves no other.
TEST_F(SeedsInSpace, AWallThatVoxelsDoNotResolveMovesNoOtherSeed) {
  const auto box = [](const glm::dvec3& low, const glm::dvec3& high) {
    TriangleMesh mesh = shapes::cube(1.0, glm::dvec3(0.5));
    for (glm::dvec3& v : mesh.vertices) v = low + v * (high - low);
    return mesh;
  };
  TriangleMesh mesh = box({0.0, 0.0, 0.0}, {1.0, 1.0, 0.2});
  for (int fin = 0; fin < 11; ++fin) {
    const double x = 0.05 + 0.09 * fin;
    mesh = shapes::append(mesh, box({x, 0.0, 0.1}, {x + 0.008, 1.0, 1.0}));
  }
  const PreparedSolid coarse = solidOf(mesh, 32, device()), fine = solidOf(mesh, 256, device());
  ASSERT_EQ(coarse.components.count(), fine.components.count());
  for (const Sampler sampler : kSamplers) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const SeedOptions options{.pieces = 24, .seed = seed, .sampler = sampler};
      const std::vector<Seed> a = seedsOf(coarse, options), b = seedsOf(fine, options);
      std::size_t moved = 0, inFins = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        const glm::dvec3 at = fine.solid.frame.worldFromIndex(pointOf(b[i]));
        const bool isInFin = at.z > 0.2;
        inFins += isInFin;
        moved += !isInFin && glm::length(coarse.solid.frame.worldFromIndex(pointOf(a[i])) - at) >
                                 mostApart(coarse.solid);
      }
      EXPECT_EQ(moved, 0u) << static_cast<int>(sampler) << ' ' << seed;
      EXPECT_GT(inFins, 0u);
    }
  }
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

// Faces through voxel centers: 50 voxels along a side of 10 have them at 2.5 and 7.5.
TEST_F(SeedsInSpace, FacesOnVoxelCentersBoundTheSameRegion) {
  TriangleMesh mesh = shapes::cube(10.0);
  mesh = shapes::append(mesh, shapes::inverted(shapes::cube(5.0)));
  for (const Fill fill : {Fill::winding, Fill::parity, Fill::flood}) {
    const PreparedSolid at50 = solidOf(mesh, 50, device(), fill);
    for (const Seed& seed : seedsOf(at50, {.pieces = 400, .seed = 3})) {
      const glm::dvec3 p = glm::abs(at50.solid.frame.worldFromIndex(pointOf(seed)));
      EXPECT_GE(std::max({p.x, p.y, p.z}), 2.5 - 0.5 * at50.solid.frame.voxelSize);
    }
    expectSame(at50, solidOf(mesh, 64, device(), fill), {.pieces = 400, .seed = 3});
  }
}

TEST_F(SeedsInSpace, AnImpactWiderThanTheBoxIsUniform) {
  const TriangleMesh mesh = shapes::ball(1.0, 4);
  const PreparedSolid coarse = solidOf(mesh, 40, device()), fine = solidOf(mesh, 97, device());
  const Impact wide{.target = glm::dvec3{0, 0, 2}, .count = 6, .sigma = 50.0};
  expectSame(coarse, fine, {.pieces = 8, .seed = 4, .impacts = {wide}});
}

// Uniform by volume, whatever the resolution: the share in each half of a ball's octants.
TEST_F(SeedsInSpace, AreUniformInTheMesh) {
  const PreparedSolid ball = solidOf(shapes::ball(1.0, 5), 24, device());
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
  const PreparedSolid ball = solidOf(shapes::ball(1.0, 4), 14, device());
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
  const PreparedSolid ball = solidOf(shapes::ball(1.0, 4), 40, device());
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
