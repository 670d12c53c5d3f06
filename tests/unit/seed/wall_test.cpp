// Walls of plates, shells and balls, whose middle and normals are known.
#include "seed/draw/wall.h"

#include <gtest/gtest.h>
#include <sherd/labels.h>
#include <sherd/seeds.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "grow/sized/crack_areas.h"
#include "kernels/device_fixture.h"
#include "pipeline/fracture_stages.h"
#include "shapes.h"

namespace sherd {
namespace {

using WallSeeds = DeviceTest;

TriangleMesh plateOf(double thickness) { return shapes::box({2.0, 2.0, thickness}); }

// The level set is linear between voxels, so thicknesses are good to a tenth of a voxel.
TEST(Walls, OfAPlateHaveItsThicknessAndMiddle) {
  for (const double thickness : {0.03, 0.1, 0.3}) {
    const Solid solid = voxelize(plateOf(thickness), {.resolution = 100});
    const double h = solid.frame.voxelSize;
    const Walls walls(solid);
    for (const glm::dvec3& at : {glm::dvec3(0.2, 0.1, 0.4 * thickness),
                                 {-0.5, 0.3, -0.45 * thickness},
                                 {0.0, 0.0, 0.7 * thickness}}) {
      const auto wall = walls.at(solid.frame.indexFromWorld(at), thickness / h + 1.0);
      ASSERT_TRUE(wall) << thickness;
      EXPECT_NEAR(wall->thickness, thickness / h, 0.1);
      EXPECT_NEAR(solid.frame.worldFromIndex(wall->middle).z, 0.0, 0.1 * h);
      EXPECT_NEAR(std::abs(wall->normal.z), 1.0, 1e-6);
      EXPECT_FALSE(walls.at(solid.frame.indexFromWorld(at), thickness / h - 1.0));
    }
  }
}

TEST(Walls, OfAShellLieBetweenItsSurfaces) {
  const Solid solid = voxelize(shapes::hollowBall(1.0, 0.9), {.resolution = 128});
  const double h = solid.frame.voxelSize;
  const Walls walls(solid);
  for (int i = 0; i < 50; ++i) {
    const double z = -0.98 + 0.04 * i, turn = 2.4 * i, r = std::sqrt(1.0 - z * z);
    const glm::dvec3 out(r * std::cos(turn), r * std::sin(turn), z);
    for (const double depth : {0.905, 0.93, 0.97, 0.995}) {
      const glm::dvec3 middle = wallMiddle(walls, solid.frame.indexFromWorld(depth * out), 0.2 / h);
      EXPECT_NEAR(glm::length(glm::dvec3(solid.frame.worldFromIndex(middle))), 0.95, 0.2 * h)
          << depth;
      EXPECT_NEAR(glm::length(solid.frame.worldFromIndex(middle) - 0.95 * out), 0.0, 0.5 * h);
    }
  }
}

TEST(Walls, AreNotFoundInABallNorFarAway) {
  const Solid solid = voxelize(shapes::ball(1.0), {.resolution = 64});
  const Walls walls(solid);
  for (const glm::dvec3& at : {glm::dvec3(0.0), {0.9, 0.0, 0.0}, {0.99, 0.0, 0.0}}) {
    EXPECT_FALSE(walls.at(solid.frame.indexFromWorld(at), 30.0));
  }
  EXPECT_FALSE(walls.at({1e300, 0.0, 0.0}, 10.0));
  EXPECT_FALSE(walls.at({NAN, 0.0, 0.0}, 10.0));
}

TEST(Walls, AreWalkedAlongByArcLength) {
  const Solid solid = voxelize(shapes::hollowBall(1.0, 0.9), {.resolution = 128});
  const double h = solid.frame.voxelSize;
  const Walls walls(solid);
  const std::vector<double> lengths{3.0, 10.5, 40.0, 90.0};
  const auto points =
      walls.walk(solid.frame.indexFromWorld({0.0, 0.0, 1.0}), {1.0, 1.0, 0.0}, lengths);
  ASSERT_EQ(points.size(), lengths.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const glm::dvec3 at = solid.frame.worldFromIndex(points[i]);
    EXPECT_NEAR(std::atan2(std::hypot(at.x, at.y), at.z), lengths[i] * h, 0.01 * lengths[i] * h);
    EXPECT_NEAR(at.x, at.y, 0.5 * h);
  }
}

TEST(Walls, EndAtTheEdgeOfAPlate) {
  const Solid solid = voxelize(plateOf(0.1), {.resolution = 100});
  const Walls walls(solid);
  const glm::dvec3 middle = solid.frame.indexFromWorld({0.0, 0.0, 0.05});
  EXPECT_EQ(walls.walk(middle, {1.0, 0.0, 0.0}, {10.0, 30.0, 49.0, 52.0, 60.0}).size(), 3u);
  EXPECT_EQ(walls.walk(middle, {1.0, 0.6, 0.0}, {10.0, 50.0, 62.0}).size(), 2u);
}

// Mean angle between cracks and the shell's normals, which point away from the center; 0 where all
// cracks cross the wall at right angles to its surface.
double tiltOf(SeedsOn on, Device& device) {
  double sum = 0.0, faces = 0.0;
  const PreparedSolid shell =
      prepared(voxelize(shapes::hollowBall(1.0, 0.9), {.resolution = 96}), device);
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const std::vector<Seed> seeds =
        placeSeeds(shell.solid, shell.components, {.pieces = 60, .seed = seed, .on = on});
    const Labels labels = std::move(grow(shell.solid.blocks, std::span(&seeds, 1), device).front());
    for (const CrackArea& crack : crackAreas(labels)) {
      const glm::dvec3 a = shell.solid.frame.worldFromIndex(pointOf(seeds[crack.a - 1u])),
                       b = shell.solid.frame.worldFromIndex(pointOf(seeds[crack.b - 1u]));
      const glm::dvec3 normal = glm::normalize(a - b), out = glm::normalize(a + b);
      sum += crack.faces * std::asin(std::min(std::abs(glm::dot(normal, out)), 1.0));
      faces += crack.faces;
    }
  }
  return sum / faces * 180.0 / std::numbers::pi;
}

TEST_F(WallSeeds, SeedsInTheMiddleMakeCracksCrossAtRightAngles) {
  EXPECT_GT(tiltOf(SeedsOn::volume, device()), 3.0);
  EXPECT_LT(tiltOf(SeedsOn::wall, device()), 0.5);
}

// Points inside a ball do not move.
TEST_F(WallSeeds, SeedsOfAThickSolidAreThoseOfTheVolume) {
  const PreparedSolid ball = prepared(voxelize(shapes::ball(1.0), {.resolution = 48}), device());
  for (const Sampler sampler : {Sampler::uniform, Sampler::halton, Sampler::poisson}) {
    EXPECT_EQ(placeSeeds(ball.solid, ball.components,
                         {.pieces = 20, .sampler = sampler, .on = SeedsOn::wall}),
              placeSeeds(ball.solid, ball.components, {.pieces = 20, .sampler = sampler}));
  }
}

}  // namespace
}  // namespace sherd
