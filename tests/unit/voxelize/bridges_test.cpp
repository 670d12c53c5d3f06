// Thin walls that stay in one piece.
#include "voxelize/bodies/bridges.h"

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
int componentsOf(const Solid& solid) {
  std::set<Voxel> left;
  solid.blocks->forEachInside([&](std::size_t voxelIndex) {
    const openvdb::Coord v = solid.blocks->voxelAt(voxelIndex);
    left.insert({v.x(), v.y(), v.z()});
  });
  int components = 0;
  for (; !left.empty(); ++components) {
    std::vector<Voxel> front{*left.begin()};
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
  }
  return components;
}

// A plate of 30 by 30 voxels of size 1, turned.
TriangleMesh turnedPlate(double thickness, const glm::dmat3& turn, const glm::dvec3& offset) {
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
    const TriangleMesh mesh =
        turnedPlate(kHeldWallVoxels, glm::mat3_cast(glm::normalize(q)), offset);
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

}  // namespace
}  // namespace sherd
