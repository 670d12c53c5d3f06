// Triangles that cross each other once they are rounded.
#include "clean/rounded_crossings.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "shapes.h"

namespace sherd {
namespace {

// A triangle in the plane z = 1, and one with its tip at a height above it.
TriangleMesh withTip(double height, glm::dvec3 shift = glm::dvec3(0.0)) {
  TriangleMesh mesh{{{0, 0, 1}, {4, 0, 1}, {0, 4, 1}, {1, 1, 1 + height}, {1, 0, 5}, {0, 1, 5}},
                    {{0, 1, 2}, {3, 4, 5}}};
  for (glm::dvec3& v : mesh.vertices) v += shift;
  return mesh;
}

TEST(RoundedCrossings, AGapBelowSinglePrecisionCloses) {
  EXPECT_EQ(roundedCrossings(withTip(0x1p-30)), 1u);
  EXPECT_EQ(roundedCrossings(withTip(0x1p-20)), 0u);  // a float
  EXPECT_EQ(roundedCrossings(withTip(0x1p-20 * (1 + 0x1p-30))), 0u);
}

TEST(RoundedCrossings, OfCracksCountAtTheirRim) {
  TriangleMesh mesh = withTip(0x1p-30);
  mesh.neighbor = {2, 2};
  EXPECT_EQ(roundedCrossings(mesh), 0u);
  mesh.triangles.push_back({3, 5, 0});  // the second triangle meets the original surface
  mesh.neighbor.push_back(0);
  EXPECT_GE(roundedCrossings(mesh), 1u);
}

TEST(RoundedCrossings, WhatCrossesBeforeDoesNotCount) {
  EXPECT_EQ(roundedCrossings(withTip(-0x1p-30)), 0u);
  EXPECT_EQ(roundedCrossings(withTip(-0.5, {0.1, 0.1, 0.1})), 0u);
}

TEST(RoundedCrossings, VerticesThatBecomeOneConnectTheirTriangles) {
  TriangleMesh mesh = withTip(0.0);
  mesh.vertices[3] = {0x1p-60, 0, 1};  // beside a corner of the other
  EXPECT_EQ(roundedCrossings(mesh), 0u);
}

TEST(RoundedCrossings, ShapesHaveNone) {
  EXPECT_EQ(roundedCrossings(shapes::ball(1.0, 4)), 0u);
  EXPECT_EQ(roundedCrossings(shapes::cup(1.0, 0.1, 1.5, 0.15, 40)), 0u);
  EXPECT_EQ(roundedCrossings({}), 0u);
}

}  // namespace
}  // namespace sherd
