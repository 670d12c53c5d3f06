// Objects far from the origin: what single precision loses, and what moving them to the origin
// keeps.
#include <gtest/gtest.h>
#include <sherd/options.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "folder/manifest/rounding.h"
#include "seed/draw/density.h"
#include "shapes.h"

namespace sherd {
namespace {

Solid solidAt(double where, double voxelSize) {
  Solid solid;
  solid.frame = {glm::dvec3(where), voxelSize};
  solid.box = {{0, 0, 0}, {99, 99, 99}};
  return solid;
}

WriteOptions meshes(std::vector<MeshFileFormat> formats, Precision precision) {
  WriteOptions write;
  write.meshFormats = std::move(formats);
  write.precision = precision;
  return write;
}

TEST(Rounding, IsHalfAStepOfFloatsAtTheFarthestPoint) {
  for (const double at : {1.0, 4.5e6, -4.5e6, 1e-30, 3e30}) {
    const Solid solid = solidAt(at, std::abs(at) * 1e-9);
    const double far =
        std::max(std::abs(at), std::abs(solid.frame.worldFromIndex(solid.box.max).x));
    const auto f = static_cast<float>(far);
    const double step =
        static_cast<double>(std::nextafter(f, std::numeric_limits<float>::infinity())) -
        static_cast<double>(f);
    EXPECT_DOUBLE_EQ(singleRounding(solid), step / 2.0) << at;
    for (int k = 0; k < 100; ++k) {  // no point of the box loses more
      const double x = at + 1e-7 * at * k / 100.0;
      EXPECT_LE(std::abs(static_cast<double>(static_cast<float>(x)) - x),
                singleRounding(solid) * (1 + 1e-6));
    }
  }
}

TEST(Rounding, DoublesAreWrittenWhereFloatsLoseAHundredthOfAVoxel) {
  const WriteOptions write =
      meshes({MeshFileFormat::ply, MeshFileFormat::glb}, Precision::automatic);
  // At 2^20 floats are 2^-3 apart, so a point moves by 2^-4.
  EXPECT_FALSE(isDouble(write, false, solidAt(0x1p20, 0x1p-4 * 101)));
  EXPECT_TRUE(isDouble(write, false, solidAt(0x1p20, 0x1p-4 * 99)));
  EXPECT_TRUE(isDouble(write, /*isExact=*/true, solidAt(0x1p20, 0x1p-4 * 101)));
  EXPECT_TRUE(roundingWarning(write, solidAt(0x1p20, 0x1p-4 * 101)).empty());
  EXPECT_EQ(roundingOf(write, solidAt(0x1p20, 0x1p-4 * 99)).files,
            std::vector<std::string>{".glb"});
  EXPECT_NE(roundingWarning(write, solidAt(0x1p20, 0x1p-4 * 99)).find("recenter"),
            std::string::npos);
}

TEST(Rounding, OnlyFilesOfFloatsAreNamed) {
  const Solid far = solidAt(1e7, 1e-3);
  const std::vector<MeshFileFormat> texts{MeshFileFormat::ply, MeshFileFormat::obj,
                                          MeshFileFormat::stlText};
  EXPECT_TRUE(roundingOf(meshes(texts, Precision::automatic), far).files.empty());
  EXPECT_TRUE(roundingOf(meshes(texts, Precision::full), far).files.empty());
  EXPECT_EQ(roundingOf(meshes(texts, Precision::single), far).files.size(), 3u);
  EXPECT_TRUE(roundingOf(meshes(texts, Precision::single), solidAt(0.0, 1e-3)).files.empty());
  WriteOptions points = meshes(texts, Precision::automatic);
  points.points.count = 5;
  EXPECT_EQ(roundingOf(points, far).files, std::vector<std::string>{"points"});
  points.mesh = false;
  EXPECT_FALSE(roundingWarning(points, far).empty());
}

TEST(Recenter, FarFromTheOriginNoBitIsLost) {
  const glm::dvec3 far(499999.123456, 4500000.987, -77777.5);
  const TriangleMesh mesh = moved(shapes::ball(3.0, 2), far);
  const glm::dvec3 center = boxCenter(mesh);
  const TriangleMesh near = moved(mesh, -center);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_EQ(near.vertices[i] + center, mesh.vertices[i]);
  }
  EXPECT_LE(glm::length(boxCenter(near)), 1e-9);
}

TEST(Recenter, EachAxisIsExactByItself) {
  const double radius = 3.0;
  for (int far = 0; far < 3; ++far) {
    glm::dvec3 at(0.1, -0.7, 1.3);
    at[far] = 2.001 * radius;  // half of its length away from 0
    const TriangleMesh mesh = moved(shapes::ball(radius, 3), at);
    const glm::dvec3 center = boxCenter(mesh);
    const TriangleMesh near = moved(mesh, -center);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const long double exact = static_cast<long double>(mesh.vertices[i][axis]) - center[axis];
        const long double error = std::abs(near.vertices[i][axis] - exact);
        EXPECT_LE(error, axis == far ? 0.0L : 0x1p-54L * 2.0 * radius);
      }
    }
  }
}

TEST(Recenter, BoxesAtTheEndOfDoublesHaveACenter) {
  TriangleMesh mesh = shapes::cube(1.0);
  for (glm::dvec3& v : mesh.vertices) v = v * 1e300 + glm::dvec3(1.5e308);
  EXPECT_TRUE(std::isfinite(boxCenter(mesh).x));
}

TEST(Recenter, WhatOptionsPlaceMovesWithTheObject) {
  FractureOptions options;
  options.seeds.impacts = {
      {.target = glm::dvec3(1.0)}, {.target = Ray{glm::dvec3(2.0), glm::dvec3(0.0, 0.0, 1.0)}}, {}};
  options.seeds.given = GivenSeeds{"", {{glm::dvec3(3.0), 1}}};
  options.guides = {{.polylines = {{glm::dvec3(4.0)}}, .mesh = shapes::cube(1.0)}};
  options.seeds.density.field =
      std::make_shared<const DensityField>([](const glm::dvec3& at) { return at.x; }, 10.0);
  const glm::dvec3 by(0.5, 1.0, 2.0);
  const FractureOptions after = moved(options, by);
  EXPECT_EQ(std::get<WorldPoint>(after.seeds.impacts[0].target), glm::dvec3(1.5, 2.0, 3.0));
  const Ray ray = std::get<Ray>(after.seeds.impacts[1].target);
  EXPECT_EQ(ray.origin, glm::dvec3(2.5, 3.0, 4.0));
  EXPECT_EQ(ray.direction, glm::dvec3(0.0, 0.0, 1.0));
  EXPECT_EQ(after.seeds.given->points[0].position, glm::dvec3(3.5, 4.0, 5.0));
  EXPECT_EQ(after.guides[0].polylines[0][0], glm::dvec3(4.5, 5.0, 6.0));
  EXPECT_EQ(after.guides[0].mesh.vertices[0], options.guides[0].mesh.vertices[0] + by);
  EXPECT_EQ(after.seeds.density.field->at(glm::dvec3(3.0)), 2.5);
}

}  // namespace
}  // namespace sherd
