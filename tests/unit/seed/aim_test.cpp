// Where impacts strike.
#include <gtest/gtest.h>
#include <sherd/seeds.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "seed/draw/voxel_index.h"
#include "seed/ray.h"
#include "unit/seed/seeds_fixture.h"

namespace sherd {
namespace {

using openvdb::Coord;

class Aim : public DeviceTest {
 protected:
  static ShapeSolid make(voxel_shapes::VoxelSolid shape) { return {std::move(shape), device()}; }
};

glm::dvec3 asPoint(const Coord& c) { return {c.x(), c.y(), c.z()}; }

TEST_F(Aim, StrikeTheNearestSurfaceVoxel) {
  std::minstd_rand random(3);
  std::uniform_real_distribution<double> anywhere(-25, 25);
  for (const voxel_shapes::VoxelSolid& shape :
       {voxel_shapes::ball(9), voxel_shapes::cup(12, 2), voxel_shapes::sparseRandom(20, 1, 5)}) {
    const ShapeSolid on = make(shape);
    const std::vector<std::uint64_t> mask = surfaceMask(*on.solid.blocks);
    const VoxelIndex surface(*on.solid.blocks, mask);
    const std::set<Coord> voxels = on.surface();
    for (int i = 0; i < 1000; ++i) {
      glm::dvec3 p{anywhere(random), anywhere(random), anywhere(random)};
      if (i % 2) p = glm::floor(p) + 0.5 * (i % 4 == 1);  // ties
      Coord best = *voxels.begin();
      for (const Coord& v : voxels) {  // ascending, so that ties stay with the first
        const glm::dvec3 d = asPoint(v) - p, b = asPoint(best) - p;
        if (d.x * d.x + d.y * d.y + d.z * d.z < b.x * b.x + b.y * b.y + b.z * b.z) best = v;
      }
      ASSERT_EQ(surface.nearest(p), best) << shape.name;
    }
  }
}

// When the half line enters each voxel's cube; the first one is hit.
std::optional<Coord> firstHit(const std::set<Coord>& voxels, const glm::dvec3& origin,
                              const glm::dvec3& direction) {
  std::optional<Coord> best;
  double soonest = std::numeric_limits<double>::infinity();
  for (const Coord& v : voxels) {
    double enter = 0.0, leave = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
      if (direction[a] == 0.0) {
        if (std::abs(origin[a] - v[a]) > 0.5) leave = -1.0;
        continue;
      }
      const double t0 = (v[a] - 0.5 - origin[a]) / direction[a];
      const double t1 = (v[a] + 0.5 - origin[a]) / direction[a];
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    if (enter > leave || enter >= soonest) continue;
    soonest = enter;
    best = v;
  }
  return best;
}

TEST_F(Aim, RaysHitTheFirstVoxelOnTheirWay) {
  std::minstd_rand random(11);
  std::uniform_real_distribution<double> anywhere(-14, 14), along(-7, 7);
  for (const voxel_shapes::VoxelSolid& shape :
       {voxel_shapes::ball(7), voxel_shapes::cup(9, 1), voxel_shapes::sparseRandom(7, 3, 2)}) {
    const ShapeSolid on = make(shape);
    const VoxelIndex inside(*on.solid.blocks, on.solid.blocks->inside);
    int hits = 0, misses = 0;
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 origin{anywhere(random), anywhere(random), anywhere(random)};
      glm::dvec3 direction = glm::dvec3{along(random), along(random), along(random)} - origin;
      if (i % 3 == 1) direction[i % 9 / 3] = 0.0;  // along a plane of voxels
      if (i % 3 == 2) direction = glm::dvec3(0.0), direction[i % 9 / 3] = i % 2 ? 1e-300 : -1e300;
      const std::optional<Coord> hit = firstVoxelOnRay(inside, on.solid.box, origin, direction);
      // 1e300 is the same half line.
      ASSERT_EQ(hit, firstHit(shape.inside, origin, i % 3 == 2 ? glm::sign(direction) : direction))
          << shape.name << " " << i;
      ++(hit ? hits : misses);
    }
    EXPECT_GT(hits, 0);
    EXPECT_GT(misses, 0);
  }
}

TEST_F(Aim, ARaysSeedsLieWhereItHits) {
  const ShapeSolid ball = make(voxel_shapes::ball(10));
  const auto struck = [&](const Ray& ray) {
    return placeSeeds(ball.solid, ball.components,
                      {.pieces = 1,
                       .seed = 1,
                       .impacts = {{.target = ray, .count = 1, .sigma = 1e-9, .merge = true}}})
        .back()
        .voxel;
  };
  EXPECT_EQ(struck({{0.2, 0.1, 99}, {0, 0, -5}}), Coord(0, 0, 10));
  EXPECT_EQ(struck({{0.2, 0.1, -99}, {0, 0, 5}}), Coord(0, 0, -10));
  // From within: the nearest surface voxel, which is not (0, 10, 0).
  EXPECT_EQ(struck({{0, 8.0, 0}, {0, -1, 0}}), Coord(-1, 9, 0));
}

TEST_F(Aim, AnywhereIsOnTheSurface) {
  const ShapeSolid cup = make(voxel_shapes::cup(10, 3));
  std::set<Coord> places;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    // Of count 1 and hardly any spread, each merges where it strikes, or beside what is taken.
    const std::vector<Seed> seeds = placeSeeds(
        cup.solid, cup.components,
        {.pieces = 1, .seed = seed, .impacts = {{.count = 1, .sigma = 1e-9, .merge = true}}});
    EXPECT_TRUE(cup.onSurface(seeds[1].voxel));
    places.insert(seeds[1].voxel);
  }
  EXPECT_GT(places.size(), 40u);
}

}  // namespace
}  // namespace sherd
