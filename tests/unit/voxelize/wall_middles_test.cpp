// The middle of walls whose middle is known, and cracks that cross them at right angles.
#include "voxelize/wall_middles.h"

#include <gtest/gtest.h>
#include <sherd/fracture.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>

#include "kernels/device_fixture.h"
#include "pipeline/fracture_stages.h"
#include "seed/draw/wall.h"
#include "shapes.h"
#include "voxelize/wall_normals.h"

namespace sherd {
namespace {

using WallCracks = DeviceTest;

TriangleMesh plate(double thickness) { return shapes::box({2.0, 2.0, thickness}); }

// A tube about the z axis with flat ends.
TriangleMesh tube(double outer, double inner, double length) {
  constexpr int kSides = 96;
  TriangleMesh mesh;
  for (const double z : {-0.5 * length, 0.5 * length}) {
    for (const double radius : {outer, inner}) {
      for (int i = 0; i < kSides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kSides;
        mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
      }
    }
  }
  const auto quads = [&](unsigned a, unsigned b) {  // rings of vertices
    for (unsigned i = 0; i < kSides; ++i) {
      const unsigned next = (i + 1) % kSides;
      mesh.triangles.push_back({kSides * a + i, kSides * a + next, kSides * b + next});
      mesh.triangles.push_back({kSides * a + i, kSides * b + next, kSides * b + i});
    }
  };
  quads(0, 2);  // outside
  quads(2, 3);  // the upper end
  quads(3, 1);  // inside
  quads(1, 0);  // the lower end
  return mesh;
}

WallMiddles middlesOf(const Solid& solid) {
  return {solid, wallNormals(solid), WallMiddles::mostOf(solid)};
}

// Positions of all inside voxels, world units, and of the middle of their walls.
template <class Check>
void forEachMiddle(const Solid& solid, const Check& check) {
  const WallMiddles middles = middlesOf(solid);
  const LeafBlocks& blocks = *solid.blocks;
  blocks.forEachInside([&](std::size_t v) {
    const openvdb::Coord at = blocks.voxelAt(v);
    glm::dvec3 middle(at.x(), at.y(), at.z());
    for (int i = 0; i < 3; ++i) {
      middle[i] += middles.ways()[3 * v + static_cast<std::size_t>(i)] / 64.0;
    }
    check(solid.frame.worldFromIndex(at), solid.frame.worldFromIndex(middle));
  });
}

// The level set is linear between voxels, so a surface may lie a tenth of a voxel off; ways are
// rounded to 1/64.
TEST(WallMiddles, OfAPlateAreInItsMidPlane) {
  for (const double thickness : {0.06, 0.15}) {
    const Solid solid = voxelize(plate(thickness), {.resolution = 80});
    const double h = solid.frame.voxelSize;
    forEachMiddle(solid, [&](const glm::dvec3& at, const glm::dvec3& middle) {
      if (std::max(std::abs(at.x), std::abs(at.y)) > 1.0 - 16.0 * h) return;  // near the rim
      EXPECT_NEAR(middle.z, 0.0, 0.12 * h);
      EXPECT_NEAR(std::hypot(middle.x - at.x, middle.y - at.y), 0.0, 0.03 * h);
    });
  }
}

// Normals are means over 8 voxels, and of a ball's triangles; a shell's radius is 40 of them.
TEST(WallMiddles, OfAShellAreHalfWayBetweenItsSurfaces) {
  const Solid solid = voxelize(shapes::hollowBall(1.0, 0.9), {.resolution = 80});
  const double h = solid.frame.voxelSize;
  forEachMiddle(solid, [&](const glm::dvec3& at, const glm::dvec3& middle) {
    EXPECT_NEAR(glm::length(middle), 0.95, 0.2 * h);
    const glm::dvec3 along = middle - glm::normalize(at) * glm::length(middle);
    EXPECT_LT(glm::length(along), 0.2 * h);
  });
}

TEST(WallMiddles, OfATubeAreHalfWayBetweenItsSurfaces) {
  const Solid solid = voxelize(tube(1.0, 0.88, 3.0), {.resolution = 100});
  const double h = solid.frame.voxelSize;
  forEachMiddle(solid, [&](const glm::dvec3& at, const glm::dvec3& middle) {
    if (std::abs(at.z) > 1.5 - 16.0 * h) return;
    EXPECT_NEAR(std::hypot(middle.x, middle.y), 0.94, 0.2 * h);
    EXPECT_NEAR(middle.z, at.z, 0.1 * h);
  });
}

TEST(WallMiddles, AreTheVoxelsThemselvesInThickSolids) {
  for (const TriangleMesh& mesh : {shapes::ball(1.0), shapes::cube(1.0)}) {
    const WallMiddles middles = middlesOf(voxelize(mesh, {.resolution = 40}));
    EXPECT_EQ(middles.reach(), 0);
  }
}

TEST(WallMiddles, AroundALeafAreThoseOfItsVoxels) {
  const Solid solid = voxelize(shapes::hollowBall(1.0, 0.9), {.resolution = 40});
  const WallMiddles middles = middlesOf(solid);
  const LeafBlocks& blocks = *solid.blocks;
  const openvdb::Coord origin = blocks.origins[blocks.count() / 2];
  const WaysAround around(&middles, origin), none(nullptr, origin);
  int compared = 0;
  blocks.forEachInside([&](std::size_t v) {
    const openvdb::Coord at = blocks.voxelAt(v), from = at - origin;
    for (int i = 0; i < 3; ++i) {
      if (from[i] < -2 || from[i] > 9) return;
    }
    ++compared;
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(around.middleAt(at)[i],
                64 * at[i] + middles.ways()[3 * v + static_cast<std::size_t>(i)]);
      EXPECT_EQ(none.middleAt(at)[i], 64 * at[i]);
    }
  });
  EXPECT_GT(compared, 100);
}

TEST(WallMiddles, StopOnRequest) {
  const Solid solid = voxelize(shapes::hollowBall(1.0, 0.9), {.resolution = 40});
  Progress progress;
  progress.cancelled = [] { return true; };
  EXPECT_THROW((void)WallMiddles(solid, wallNormals(solid), 20.0, &progress), Error);
}

// Whichever task asks first finds them for all.
TEST(SolidWalls, AreTheSameForAllTasks) {
  SolidWalls walls(voxelize(shapes::hollowBall(1.0, 0.9), {.resolution = 64}));
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 8);
  std::array<std::shared_ptr<const WallMiddles>, 64> found;
  tbb::task_arena(8).execute([&] {
    tbb::parallel_for(
        std::size_t{0}, found.size(), [&](std::size_t i) { found[i] = walls.middles(nullptr); },
        tbb::simple_partitioner());
  });
  ASSERT_TRUE(found.front());
  for (const auto& middles : found) EXPECT_EQ(middles, found.front());
}

TEST(ThinSolids, AreVesselsShellsAndPlates) {
  const Solid shell = voxelize(shapes::hollowBall(1.0, 0.9), {.resolution = 64}),
              sheet = voxelize(plate(0.06), {.resolution = 64}),
              pipe = voxelize(tube(1.0, 0.88, 3.0), {.resolution = 64}),
              cube = voxelize(shapes::cube(1.0), {.resolution = 32}),
              ball = voxelize(shapes::ball(1.0), {.resolution = 32});
  for (const std::size_t pieces : {2u, 10u, 60u}) {
    for (const Solid* thin : {&shell, &sheet, &pipe}) {
      EXPECT_TRUE(isThin(*thin, pieces));
      EXPECT_EQ(resolved(SeedsOn::automatic, *thin, pieces), SeedsOn::wall);
    }
    for (const Solid* thick : {&cube, &ball}) {
      EXPECT_FALSE(isThin(*thick, pieces));
      EXPECT_EQ(resolved(SeedsOn::automatic, *thick, pieces), SeedsOn::volume);
    }
  }
  // A wall is thin beside its pieces, so not beside ones of a voxel.
  EXPECT_FALSE(isThin(shell, shell.voxels));
  EXPECT_FALSE(isThin(shell, 1));
  EXPECT_EQ(resolved(SeedsOn::surface, shell, 10), SeedsOn::surface);
}

TEST(ThinSolids, AreThinAtAnyResolution) {
  for (const TriangleMesh& mesh : {shapes::torus(1.0, 0.4), shapes::cup(1.0, 0.3, 1.6, 0.3),
                                   shapes::box({2.0, 1.7, 0.4}), shapes::hollowBall(1.0, 0.7)}) {
    const Solid coarse = voxelize(mesh, {.resolution = 40}),
                fine = voxelize(mesh, {.resolution = 97});
    bool isAnyThin = false, isAnyThick = false;
    for (std::size_t pieces = 2; pieces < 200; pieces += 1 + pieces / 8) {
      const bool isCoarse = isThin(coarse, pieces);
      EXPECT_EQ(isCoarse, isThin(fine, pieces)) << pieces;
      (isCoarse ? isAnyThin : isAnyThick) = true;
    }
    EXPECT_TRUE(isAnyThick);
    EXPECT_TRUE(isAnyThin || mesh.vertices.size() == 96 * 48);  // a torus never is
  }
}

// The mean angle in degrees between cracks and the direction across the wall at them.
template <class Across>
double leanOf(const TriangleMesh& mesh, SeedsOn on, Growth growth, const Across& across,
              Device& device) {
  double sum = 0.0, area = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    FractureOptions options{.pieces = 16, .seed = seed};
    options.solid.resolution = 80;
    options.seeds.on = on;
    options.grow.growth = growth;
    options.surface.interface = Interface::shared;
    for (const Fragment& fragment : fracture(mesh, options, device).fragments) {
      const TriangleMesh& own = fragment.mesh;
      for (std::size_t i = 0; i < own.triangles.size(); ++i) {
        if (own.neighbor[i] == 0) continue;
        const glm::uvec3& t = own.triangles[i];
        const glm::dvec3 &a = own.vertices[t.x], &b = own.vertices[t.y], &c = own.vertices[t.z];
        const glm::dvec3 twice = glm::cross(b - a, c - a);
        const double length = glm::length(twice);
        if (length == 0.0) continue;
        const double sine = std::abs(glm::dot(twice / length, across((a + b + c) / 3.0)));
        sum += 0.5 * length * std::asin(std::min(sine, 1.0));
        area += 0.5 * length;
      }
    }
  }
  EXPECT_GT(area, 0.0);
  return sum / area * 180.0 / std::numbers::pi;
}

// Meshes bend by some degrees in the voxel where cracks meet or reach the surface.  A shell has no
// rim, so nothing else leans.
TEST_F(WallCracks, OfAShellAreAtRightAnglesByDefault) {
  const TriangleMesh shell = shapes::hollowBall(1.0, 0.85);
  const auto across = [](const glm::dvec3& at) { return glm::normalize(at); };
  for (const Growth growth : {Growth::sequential, Growth::euclid}) {
    const auto lean = [&](SeedsOn on) { return leanOf(shell, on, growth, across, device()); };
    EXPECT_LT(lean(SeedsOn::automatic), 2.5);
    EXPECT_GT(lean(SeedsOn::volume), 5.0);
  }
}

TEST_F(WallCracks, OfATubeAreAtRightAnglesByDefault) {
  const TriangleMesh pipe = tube(1.0, 0.85, 3.0);
  const auto across = [](const glm::dvec3& at) {
    return glm::normalize(glm::dvec3(at.x, at.y, 0.0));
  };
  const auto lean = [&](SeedsOn on) {
    return leanOf(pipe, on, Growth::sequential, across, device());
  };
  EXPECT_LT(lean(SeedsOn::automatic), 3.0);
  EXPECT_GT(lean(SeedsOn::volume), 6.0);
}

TEST_F(WallCracks, OfAPlateAreAtRightAnglesByDefault) {
  const auto across = [](const glm::dvec3&) { return glm::dvec3(0.0, 0.0, 1.0); };
  for (const Growth growth : {Growth::sequential, Growth::euclid}) {
    EXPECT_LT(leanOf(plate(0.12), SeedsOn::automatic, growth, across, device()), 2.5);
  }
}

TEST_F(WallCracks, FollowWallsThatAreFoundOnceForASolid) {
  const PreparedSolid shell =
      prepared(voxelize(shapes::hollowBall(1.0, 0.9), {.resolution = 48}), device());
  const auto labels = [&](const PreparedSolid& solid, std::uint64_t seed, SeedsOn on) {
    FractureOptions options;
    options.pieces = 20;
    options.seed = seed;
    options.seeds.on = on;
    return fracture(solid, options, device()).labels;
  };
  EXPECT_FALSE(labels(shell, 1, SeedsOn::volume).walls);
  const Labels first = labels(shell, 1, SeedsOn::wall);
  ASSERT_TRUE(first.walls);
  EXPECT_EQ(labels(shell, 2, SeedsOn::wall).walls, first.walls);

  const Labels alone = labels({shell.solid, shell.components}, 1, SeedsOn::wall);
  EXPECT_NE(alone.walls, first.walls);
  EXPECT_EQ(alone.fragment, first.fragment);
}

// Seeds that are placed anew for the least share, or at centers, have middles of their own too.
TEST_F(WallCracks, FollowWallsAlsoFromSeedsThatAreMoved) {
  const PreparedSolid flat = prepared(voxelize(plate(0.2), {.resolution = 64}), device());
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    FractureOptions options;
    options.pieces = 300;
    options.seed = seed;
    options.seeds.on = SeedsOn::wall;
    options.shares.minShare = 0.3 / options.pieces;
    options.shares.balance = seed % 2 == 0 ? 0 : 2;
    EXPECT_TRUE(grow(flat, options, device(), {}, nullptr).result.labels.walls) << seed;
  }
}

}  // namespace
}  // namespace sherd
