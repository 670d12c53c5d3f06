// The resolution that is chosen for a mesh.
#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/error.h>
#include <sherd/fracture.h>
#include <sherd/solid.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "shapes.h"

namespace sherd {
namespace {

// A box from the origin to `size`.
TriangleMesh block(const glm::dvec3& size) {
  TriangleMesh mesh = shapes::cube(1.0, glm::dvec3(0.5));
  for (glm::dvec3& v : mesh.vertices) v *= size;
  return mesh;
}

// A cone of radius 1 on z = 0.
TriangleMesh cone(double height) {
  constexpr int kSegments = 96;
  TriangleMesh mesh{{{0.0, 0.0, height}, {0.0, 0.0, 0.0}}, {}};
  for (int i = 0; i < kSegments; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSegments;
    mesh.vertices.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  for (unsigned i = 0; i < kSegments; ++i) {
    const unsigned a = 2 + i, b = 2 + (i + 1) % kSegments;
    mesh.triangles.push_back({0, a, b});
    mesh.triangles.push_back({1, b, a});
  }
  return mesh;
}

// Bars along the axes, `count` by `count` each way, that unite where they cross.
TriangleMesh barLattice(int count, double side, double thickness) {
  TriangleMesh all;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j) {
        glm::dvec3 size(thickness), from(0.0);
        size[axis] = side + thickness;
        from[(axis + 1) % 3] = side * i / (count - 1);
        from[(axis + 2) % 3] = side * j / (count - 1);
        all = shapes::append(all, shapes::transformed(block(size), 1.0, from));
      }
    }
  }
  return all;
}

// What the solid's mesh lacks of `expected`, as a share.
double lost(const TriangleMesh& mesh, int resolution, double expected) {
  static Device device;
  const FractureOptions options{.pieces = 1, .solid = {.resolution = resolution}};
  double sum = 0.0;
  for (const Fragment& f : fracture(mesh, options, device).fragments) sum += volume(f.mesh);
  return 1.0 - sum / expected;
}

TEST(Resolution, ThickThingsStayAtTheLeast) {
  for (const TriangleMesh& mesh : {shapes::ball(1.0), shapes::cube(1.0), shapes::torus(1.0, 0.3),
                                   shapes::cup(1.0, 0.1, 1.6, 0.2), shapes::hollowBall(1.0, 0.9)}) {
    EXPECT_EQ(automaticResolution(mesh), kLeastAutoResolution);
  }
}

TEST(Resolution, SharpEdgesNeedNoMore) {
  for (const double height : {0.4, 0.6, 1.0, 3.0}) {  // from 22 degrees at the rim to 37 at the tip
    EXPECT_EQ(automaticResolution(cone(height)), kLeastAutoResolution) << height;
  }
}

TEST(Resolution, AWallGetsAVoxelAndAHalf) {
  // 1.5 * 64 / thickness, and up to the next multiple of eight.
  EXPECT_EQ(automaticResolution(block({64.0, 64.0, 0.75})), 128);
  EXPECT_EQ(automaticResolution(block({64.0, 64.0, 0.7})), 144);
  EXPECT_EQ(automaticResolution(block({64.0, 64.0, 0.39})), 248);
  EXPECT_EQ(automaticResolution(block({64.0, 64.0, 0.1875})), 512);
  EXPECT_EQ(automaticResolution(block({64.0, 64.0, 0.01})), kMostAutoResolution);
}

TEST(Resolution, ThinThingsKeepTheirVolume) {
  const TriangleMesh pane = block({64.0, 64.0, 0.39});
  EXPECT_GT(lost(pane, 128, volume(pane)), 0.1);
  EXPECT_LE(lost(pane, kAutoResolution, volume(pane)), 0.03);
  const double side = 8.0, thick = 0.25;
  const int count = 3;
  const TriangleMesh bars = barLattice(count, side, thick);
  const double crossings = std::pow(count, 3) * std::pow(thick, 3);  // three bars in one cube
  const double all = 3 * count * count * (side + thick) * thick * thick - 2.0 * crossings;
  EXPECT_LE(lost(bars, kAutoResolution, all), 0.03);
}

TEST(Resolution, IsTheSameWhereAMeshIsMovedAndScaled) {
  for (const TriangleMesh& mesh : {shapes::cup(1.0, 0.0125, 1.5, 0.25), barLattice(2, 8.0, 0.25)}) {
    const int resolution = automaticResolution(mesh);
    EXPECT_GT(resolution, kLeastAutoResolution);
    for (const double scale : {0.25, 1.0, 1024.0}) {
      EXPECT_EQ(automaticResolution(shapes::transformed(mesh, scale, {-64.0, 32.0, 8.0})),
                resolution);
    }
  }
}

// A square bar with sides of normals (1, 1, 1) and (0, 1, -1).
TriangleMesh obliqueBar(double thickness) {
  const glm::dvec3 across = glm::normalize(glm::dvec3(1, 1, 1)),
                   beside = glm::normalize(glm::dvec3(0, 1, -1));
  TriangleMesh bar = shapes::cube(1.0);
  for (glm::dvec3& v : bar.vertices) {
    v = thickness * (v.x * across + v.y * beside) + v.z * glm::cross(across, beside);
  }
  return bar;
}

TEST(Resolution, IsTheSameWhereAMeshIsTurned) {
  std::vector<TriangleMesh> meshes{shapes::cup(1.0, 0.0125, 1.5, 0.25), barLattice(2, 8.0, 0.25)};
  for (int k = 0; k < 60; ++k) meshes.push_back(obliqueBar(0.012 + 0.0002 * k));
  for (const TriangleMesh& mesh : meshes) {
    const int resolution = automaticResolution(mesh);
    EXPECT_GT(resolution, kLeastAutoResolution);
    for (int axis = 0; axis < 3; ++axis) {
      TriangleMesh turned = mesh;
      for (glm::dvec3& v : turned.vertices) {
        const glm::dvec3 before = v;
        v[(axis + 1) % 3] = -before[(axis + 2) % 3];
        v[(axis + 2) % 3] = before[(axis + 1) % 3];
      }
      EXPECT_EQ(automaticResolution(turned), resolution) << axis;
    }
  }
}

TEST(Resolution, WhatLiesWithinTheSolidIsNoWall) {
  // Two blocks that overlap by a hair, and a pane within a block.
  const TriangleMesh left = shapes::cube(1.0), right = shapes::cube(1.0, {0.999, 0.0, 0.0});
  EXPECT_EQ(automaticResolution(shapes::append(left, right)), kLeastAutoResolution);
  const TriangleMesh pane = shapes::transformed(block({0.5, 0.5, 0.002}), 1.0, {-0.25, -0.25, 0.0});
  EXPECT_EQ(automaticResolution(shapes::append(left, pane)), kLeastAutoResolution);
}

TEST(Resolution, ShellsAreAsThickAsTheyAreMade) {
  const TriangleMesh pane = block({64.0, 64.0, 0.39});
  EXPECT_EQ(automaticResolution(pane, {.fill = Fill::shell}), kLeastAutoResolution);
  EXPECT_EQ(automaticResolution(pane, {.shellThickness = 0.5}), kLeastAutoResolution);
  TriangleMesh sheet = pane;
  sheet.triangles.resize(2);
  EXPECT_EQ(automaticResolution(sheet), kLeastAutoResolution);
}

TEST(Resolution, VoxelizeChoosesTheSameAndReportsIt) {
  const TriangleMesh pane = block({64.0, 64.0, 0.7});
  const Solid solid = voxelize(pane);
  EXPECT_TRUE(solid.report.resolution.automatic);
  EXPECT_EQ(solid.report.resolution.resolution, 144);
  EXPECT_EQ(solid.frame.voxelSize, 64.0 / 144);
  EXPECT_EQ(solid.report.walls.resolution, 0);
  const Solid given = voxelize(pane, {.resolution = 144});
  EXPECT_FALSE(given.report.resolution.automatic);
  EXPECT_EQ(given.frame.voxelSize, solid.frame.voxelSize);
  EXPECT_EQ(given.voxels, solid.voxels);
  const Solid coarse = voxelize(pane, {.voxelSize = 0.5});
  EXPECT_FALSE(coarse.report.resolution.automatic);
  EXPECT_EQ(coarse.report.resolution.resolution, 128);
  EXPECT_EQ(coarse.report.walls.resolution, 138);
}

TEST(Resolution, ShortMemoryNamesTheOneToAskFor) {
  const TriangleMesh pane = block({64.0, 64.0, 0.39});
  const std::uint64_t needed = estimatedMemory(pane, {});
  EXPECT_EQ(needed, estimatedMemory(pane, {.solid = {.resolution = 248}}));
  EXPECT_NO_THROW(requireMemory(pane, {}, needed));
  try {
    requireMemory(pane, {}, needed - 1);
    FAIL();
  } catch (const Error& e) {
    const std::string sentence = e.what();
    EXPECT_NE(sentence.find("a resolution of 247 fits"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("one of 248, which the mesh's walls need,"), std::string::npos)
        << sentence;
  }
}

}  // namespace
}  // namespace sherd
