// Exact winding numbers of voxel columns.
#include "voxelize/winding.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "shapes.h"

namespace sherd {
namespace {

std::uint64_t countInside(const TriangleMesh& mesh, int extent) {
  const Winding winding(mesh);
  std::uint64_t count = 0;
  for (int x = -extent; x <= extent; ++x) {
    for (int y = -extent; y <= extent; ++y) {
      for (int z = -extent; z <= extent; ++z) count += winding.isInside({x, y, z}) ? 1 : 0;
    }
  }
  EXPECT_EQ(count, winding.insideVoxels());
  return count;
}

TEST(Winding, ACubeHoldsTheCentersInIt) {
  EXPECT_EQ(countInside(shapes::cube(9.0, {0.5, 0.5, 0.5}), 16),
            9u * 9 * 9);  // -4 .. 5, 4 or 5 on the face
  EXPECT_EQ(countInside(shapes::cube(8.5), 16), 9u * 9 * 9);
}

TEST(Winding, FacesThroughCentersAreHalfOpen) {
  // Every face of the cube passes voxel centers: each axis takes one of its two faces.
  EXPECT_EQ(countInside(shapes::cube(10.0), 16), 10u * 10 * 10);
}

TEST(Winding, ABallHoldsTheCentersWithinItsRadius) {
  // Between the inscribed polyhedron's insphere and its circumsphere a center may go either way;
  // count outside that.
  const double radius = 20.3;
  const TriangleMesh mesh = shapes::ball(radius, 5);
  const Winding winding(mesh);
  int wrong = 0;
  for (int x = -24; x <= 24; ++x) {
    for (int y = -24; y <= 24; ++y) {
      for (int z = -24; z <= 24; ++z) {
        const double r = std::sqrt(static_cast<double>(x * x + y * y + z * z));
        if (r > radius * 0.998 && r < radius) continue;
        wrong += winding.isInside({x, y, z}) != (r < radius) ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(wrong, 0);
}

TEST(Winding, OverlapsCountTwiceAndCavitiesNotAtAll) {
  const Winding two(
      shapes::append(shapes::ball(10, 4, {-4, 0, 0}), shapes::ball(10, 4, {4, 0, 0})));
  EXPECT_EQ(two.lowest(), 0);
  EXPECT_EQ(two.highest(), 2);
  const Winding hollow(shapes::hollowBall(12, 6));
  EXPECT_EQ(hollow.lowest(), 0);
  EXPECT_EQ(hollow.highest(), 1);
  EXPECT_FALSE(hollow.isInside({0, 0, 0}));
  EXPECT_TRUE(hollow.isInside({9, 0, 0}));
}

TEST(Winding, EveryColumnOfAClosedMeshEndsOutside) {
  // Vertices on, and edges through, voxel centers are the hard case: random meshes with corners on
  // integers.
  std::minstd_rand random(5);
  for (int round = 0; round < 200; ++round) {
    TriangleMesh mesh = shapes::ball(6.0, 1);
    for (glm::dvec3& v : mesh.vertices) {
      v = glm::dvec3(static_cast<int>(random() % 13) - 6, static_cast<int>(random() % 13) - 6,
                     static_cast<int>(random() % 13) - 6);
    }
    const Winding winding(mesh);
    for (int x = -8; x <= 8; ++x) {
      for (int y = -8; y <= 8; ++y) {
        ASSERT_EQ(winding.windingAbove(x, y), 0) << "column " << x << ", " << y << " never ends";
      }
    }
  }
}

}  // namespace
}  // namespace sherd
