// Lengths relative to the longest side, against the same lengths in voxels.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/fracture.h>

#include <cmath>
#include <string>

#include "erode/passes.h"
#include "kernels/device_fixture.h"
#include "shapes.h"

namespace sherd {
namespace {

TEST(Lengths, AreVoxelsOrAShareOfTheSide) {
  EXPECT_EQ(Length(3.5).over(1000.0), 3.5);
  EXPECT_EQ(Length::ofSide(0.5).over(256.0), 1.28);
  EXPECT_TRUE(Length().isZero());
  EXPECT_FALSE(Length::ofSide(0.1).isZero());
}

TEST(Lengths, OfErosionAreRounded) {
  const auto passes = [](Length iterations, Length size, double side) {
    return passesOf({.size = size, .iterations = iterations}, side);
  };
  EXPECT_EQ(passes(4, 7, 50).count, 4);
  EXPECT_EQ(passes(4, 7, 50).size, 7);
  EXPECT_EQ(passes(Length::ofSide(1), 3, 149).count, 1);
  EXPECT_EQ(passes(Length::ofSide(1), 3, 151).count, 2);
  EXPECT_EQ(passes(Length::ofSide(1), 3, 49).count, 0);
  for (const auto& [side, size] :
       {std::pair{10.0, 3}, {39.0, 3}, {41.0, 5}, {59.0, 5}, {61.0, 7}, {139.0, 13}}) {
    EXPECT_EQ(passes(1, Length::ofSide(10), side).size, size) << side;
  }
  EXPECT_THROW((void)passes(1, Length::ofSide(10), 141), Error);
  EXPECT_THROW((void)passes(Length::ofSide(50), 3, 2002), Error);
  for (const Length bad : {Length(2), Length(4), Length(15), Length(3.5), Length(-3)}) {
    EXPECT_THROW((void)passes(1, bad, 50), Error) << bad.voxels;
  }
  for (const Length bad : {Length(-1), Length(0.5), Length(1001), Length(std::nan(""))}) {
    EXPECT_THROW((void)passes(bad, 3, 50), Error) << bad.voxels;
  }
}

using RelativeLengths = DeviceTest;

// The longest side of the mesh's box, not rounded to voxels, whatever the grid has.
TEST_F(RelativeLengths, EqualTheSameInVoxels) {
  TriangleMesh mesh = shapes::cup(1.0, 0.25, 1.6, 0.25);
  for (const double voxelSize : {0.05, 0.031}) {
    const double side = longestSide(bounds(mesh)) / voxelSize;
    FractureOptions relative{.pieces = 5, .seed = 3, .solid = {.voxelSize = voxelSize}};
    relative.surface.levelSets = relative.surface.meshes = false;
    relative.grow.roughness = Length::ofSide(2.0);
    relative.grow.roughnessWindow = Length::ofSide(15.0);
    relative.erode.iterations = Length::ofSide(3.0);
    relative.erode.size = Length::ofSide(8.0);
    FractureOptions inVoxels = relative;
    inVoxels.grow.roughness = 0.02 * side;
    inVoxels.grow.roughnessWindow = 0.15 * side;
    inVoxels.erode.iterations = std::round(0.03 * side);
    inVoxels.erode.size = 2.0 * std::round((0.08 * side - 1.0) / 2.0) + 1.0;
    EXPECT_GT(inVoxels.erode.iterations.voxels, 0.0);
    const FractureResult a = fracture(mesh, relative, device()),
                         b = fracture(mesh, inVoxels, device());
    EXPECT_EQ(a.labels.fragment, b.labels.fragment);
    EXPECT_GT(a.eroded[0], 0u);
    inVoxels.grow.roughness = 0.0;
    EXPECT_NE(fracture(mesh, inVoxels, device()).labels.fragment, b.labels.fragment);
  }
}

TEST_F(RelativeLengths, AreRefusedBeforeLongWorkWhereTheyDoNotFit) {
  FractureOptions options{.pieces = 2, .solid = {.resolution = 40}};
  const auto refusal = [&] {
    try {
      (void)fracture(shapes::ball(1.0, 3), options, device());
      return std::string("not refused");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::usage);
      return std::string(e.what());
    }
  };
  options.erode = {.size = Length::ofSide(40), .iterations = 1};
  EXPECT_NE(refusal().find("the size is 16 voxels"), std::string::npos);
  options.erode = {};
  options.grow.roughness = Length::ofSide(100);
  options.solid.resolution = 101;
  EXPECT_NE(refusal().find("the roughness is 101 voxels"), std::string::npos);
  options.grow.roughness = {};
  options.erode.longestSideVoxels = 40;
  EXPECT_NE(refusal().find("must not be set"), std::string::npos);
}

}  // namespace
}  // namespace sherd
