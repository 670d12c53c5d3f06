// Thin walls that stay in one piece, and bodies that stay apart.
#include "voxelize/bridges.h"

#include <gtest/gtest.h>
#include <sherd/solid.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <random>
#include <set>

#include "shapes.h"

namespace sherd {
namespace {

using Voxel = std::array<int, 3>;

// VoxelComponents of the solid that steps over faces lead through.
//   least  voxels of a component that counts
int componentsOf(const Solid& solid, std::size_t least = 1) {
  std::set<Voxel> left;
  solid.blocks->forEachInside([&](std::size_t voxelIndex) {
    const openvdb::Coord v = solid.blocks->voxelAt(voxelIndex);
    left.insert({v.x(), v.y(), v.z()});
  });
  int components = 0;
  while (!left.empty()) {
    std::vector<Voxel> front{*left.begin()};
    const std::size_t before = left.size();
    left.erase(left.begin());
    while (!front.empty()) {
      const Voxel at = front.back();
      front.pop_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          Voxel next = at;
          next[axis] += step;
          if (left.erase(next) > 0) front.push_back(next);
        }
      }
    }
    if (before - left.size() >= least) ++components;
  }
  return components;
}

// A plate of 30 by 30 voxels of size 1, turned.
TriangleMesh plate(double thickness, const glm::dmat3& turn, const glm::dvec3& offset) {
  TriangleMesh mesh = shapes::cube(1.0);
  for (glm::dvec3& v : mesh.vertices) v = turn * (v * glm::dvec3(30.0, 30.0, thickness)) + offset;
  return mesh;
}

TEST(Bridges, AWallOfAVoxelAndAQuarterHoldsTogetherWhateverWayItRuns) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::uint64_t bridges = 0;
  for (int i = 0; i < 60; ++i) {
    glm::dquat q(normal(random), normal(random), normal(random), normal(random));
    if (i < 20) {  // level along one axis, where whole lines of voxels can part
      const double angle = i < 10 ? std::numbers::pi / 4 : uniform(random) * std::numbers::pi;
      q = glm::dquat(std::cos(angle / 2), std::sin(angle / 2), 0.0, 0.0);
    }
    const glm::dvec3 offset(uniform(random), uniform(random), uniform(random));
    const TriangleMesh mesh = plate(kHeldWallVoxels, glm::mat3_cast(glm::normalize(q)), offset);
    const Solid solid = voxelize(mesh, {.voxelSize = 1.0});
    EXPECT_EQ(componentsOf(solid), 1) << i;
    bridges += solid.report.bridges;
  }
  EXPECT_GT(bridges, 1000u);  // without them plates fall apart
}

TEST(Bridges, ShellsHoldTogetherToo) {
  const double angle = std::numbers::pi / 4;
  const glm::dmat3 turn =
      glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2), 0.0, 0.0));
  const TriangleMesh sheet{
      {turn * glm::dvec3(-15, -15, 0), turn * glm::dvec3(15, -15, 0), turn * glm::dvec3(0, 15, 0)},
      {{0, 1, 2}}};
  const Solid solid = voxelize(sheet, {.voxelSize = 1.0, .shellThickness = kHeldWallVoxels});
  EXPECT_EQ(solid.report.fill, Fill::shell);
  EXPECT_EQ(componentsOf(solid), 1);
}

TEST(Bridges, BodiesThatNearlyTouchStayApart) {
  const TriangleMesh two =
      shapes::append(shapes::cube(10.0, {0.0, 0.0, 5.0}), shapes::cube(10.0, {10.2, 10.2, 5.0}));
  const Solid solid = voxelize(two, {.voxelSize = 1.0});
  EXPECT_EQ(componentsOf(solid), 2);
  EXPECT_EQ(solid.report.bridges, 0u);
}

TEST(Bridges, ThickSolidsNeedNone) {
  EXPECT_EQ(voxelize(shapes::torus(10.0, 4.0), {.resolution = 64}).report.bridges, 0u);
  EXPECT_EQ(voxelize(shapes::hollowBall(10.0, 8.0), {.resolution = 64}).report.bridges, 0u);
  TriangleMesh turned = shapes::cube(20.0);  // at its edges voxels touch by edges, too
  const glm::dmat3 turn = glm::mat3_cast(glm::normalize(glm::dquat(0.9, 0.1, 0.3, 0.2)));
  for (glm::dvec3& v : turned.vertices) v = turn * v;
  EXPECT_EQ(voxelize(turned, {.resolution = 128}).report.bridges, 0u);
}

// Returns a mesh turned about an axis through the origin that is parallel to no other.
TriangleMesh turned(TriangleMesh mesh) {
  const glm::dmat3 turn = glm::mat3_cast(glm::normalize(glm::dquat(0.9, 0.1, 0.3, 0.2)));
  for (glm::dvec3& v : mesh.vertices) v = turn * v;
  return mesh;
}

// A brick wall without mortar: gaps of `gap` between all of them.
TriangleMesh wall(double gap) {
  TriangleMesh all;
  for (int x = 0; x < 3; ++x) {
    for (int z = 0; z < 2; ++z) {
      const double pitch = 6.0 + gap;
      all = shapes::append(all, shapes::cube(6.0, {pitch * x + 1.7 * z, 0.3, pitch * z}));
    }
  }
  return all;
}

TEST(BodyGaps, KeepBodiesApartHoweverNearTheyAre) {
  for (const double gap : {1e-9, 0.01, 0.1, 0.5, 0.9, 1.5, 2.0}) {
    for (const bool isTurned : {false, true}) {
      const TriangleMesh mesh = isTurned ? turned(wall(gap)) : wall(gap);
      const Solid solid = voxelize(mesh, {.voxelSize = 1.0});
      EXPECT_EQ(componentsOf(solid, kSmallComponentVoxels), 6) << gap << isTurned;
      if (gap < 0.5) {
        EXPECT_GT(solid.report.gaps, 50u);
      } else if (gap > 1.9) {
        EXPECT_EQ(solid.report.gaps, 0u);
      }
    }
  }
}

TEST(BodyGaps, AreNotMadeWhereBodiesTouchOrOverlap) {
  for (const TriangleMesh& mesh :
       {wall(0.0), wall(-0.3), turned(wall(-0.3)),
        shapes::append(shapes::cube(12.0), shapes::cube(4.0, {5.7, 0.1, 0.2}))}) {
    const Solid solid = voxelize(mesh, {.voxelSize = 1.0});
    EXPECT_EQ(solid.report.gaps, 0u);
    EXPECT_EQ(componentsOf(solid), 1);
  }
}

TEST(BodyGaps, AreNotMadeInWallsAroundCavities) {
  const Solid thin = voxelize(shapes::hollowBall(10.0, 8.6), {.voxelSize = 1.0});
  EXPECT_EQ(thin.report.gaps, 0u);
  EXPECT_EQ(componentsOf(thin), 1);
  // A ball within the cavity is another body.
  const TriangleMesh three = shapes::append(shapes::hollowBall(10.0, 7.0), shapes::ball(6.8));
  const Solid both = voxelize(three, {.voxelSize = 1.0});
  EXPECT_GT(both.report.gaps, 100u);
  EXPECT_EQ(componentsOf(both), 2);
  EXPECT_NEAR(static_cast<double>(both.voxels + both.report.gaps),
              shapes::hollowBallVolume(10.0, 7.0) + 4.0 / 3.0 * std::numbers::pi * 6.8 * 6.8 * 6.8,
              60.0);
}

// They would vanish, or fall apart.
TEST(BodyGaps, AreNotMadeInThinBodies) {
  TriangleMesh cards, plates;
  for (int i = 0; i < 10; ++i) {
    cards = shapes::append(
        cards, shapes::transformed(shapes::box({32.0, 32.0, 0.95}), 1.0, {0.0, 0.0, 1.0 * i}));
  }
  for (const double z : {0.0, 1.3}) {
    plates =
        shapes::append(plates, shapes::transformed(shapes::box({40.0, 40.0, 1.2}), 1.0, {0, 0, z}));
  }
  for (const TriangleMesh& mesh : {cards, turned(plates)}) {
    const Solid solid = voxelize(mesh, {.voxelSize = 1.0});
    EXPECT_EQ(solid.report.gaps, 0u);
    EXPECT_GT(solid.report.joinedBodies, 0u);
    EXPECT_EQ(componentsOf(solid), 1);
  }
}

// One of two plates, each a voxel thick, would vanish otherwise.
TEST(BodyGaps, LeaveThinBodiesBesideThickOnes) {
  const TriangleMesh mesh =
      shapes::append(shapes::transformed(shapes::box({20.0, 20.0, 8.0}), 1.0, {0.0, 0.0, 4.0}),
                     shapes::transformed(shapes::box({20.0, 20.0, 1.0}), 1.0, {0.0, 0.0, 8.6}));
  const Solid solid = voxelize(mesh, {.voxelSize = 1.0});
  EXPECT_EQ(componentsOf(solid), 2);
  EXPECT_NEAR(static_cast<double>(solid.voxels), 20.0 * 20.0 * 8.0, 1.0);
}

}  // namespace
}  // namespace sherd
