// Exact winding numbers of voxel columns.
#include "voxelize/fill/winding.h"

#include <gtest/gtest.h>
#include <sherd/files.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <memory>
#include <random>

#include "mesh/search/winding_in_ball.h"
#include "shapes.h"
#include "voxelize/fill/caps.h"
#include "voxelize/fill/generalized_winding.h"

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

// Triangles that intersect each other, of all sizes, and the boundaries between them.
TriangleMesh scattered(std::minstd_rand& random, int triangles) {
  std::uniform_real_distribution<double> place(-30.0, 30.0), spread(-1.0, 1.0), power(-2.0, 4.0);
  TriangleMesh mesh;
  for (int i = 0; i < triangles; ++i) {
    const glm::dvec3 center(place(random), place(random), place(random));
    const double size = std::exp2(power(random));
    for (int corner = 0; corner < 3; ++corner) {
      const double x = spread(random), y = spread(random), z = spread(random);
      mesh.vertices.push_back(center + size * glm::dvec3(x, y, z));
    }
    const auto first = static_cast<std::uint32_t>(3 * i);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

TEST(WindingInBall, DiffersFromTheTreeByLessThanItsBound) {
  std::minstd_rand random(8);
  std::uniform_real_distribution<double> place(-30.0, 30.0);
  int decided = 0;
  for (int round = 0; round < 20; ++round) {
    const TriangleTree tree(round == 0 ? shapes::ball(20.0, 5) : scattered(random, 300));
    for (int ball = 0; ball < 20; ++ball) {
      const glm::dvec3 center(place(random), place(random), place(random));
      const double radius = std::exp2(ball % 5);
      const TriangleTree::WindingInBall around(tree, center, radius);
      for (int i = 0; i < 20; ++i) {
        const glm::dvec3 step(place(random), place(random), place(random));
        const glm::dvec3 point = center + radius * std::pow(0.05 * i, 0.25) * glm::normalize(step);
        EXPECT_LE(std::abs(around.at(point) - tree.winding(point)), around.error());
      }
      decided += around.error() < 0.12 ? 1 : 0;
    }
  }
  EXPECT_EQ(decided, 400) << "bounds are of no use";
}

TEST(GeneralizedWinding, DecidesOnRealMeshesAsTheWholeSumDoes) {
  const char* folder = std::getenv("SHERD_TEST_DATA");
  if (folder == nullptr) GTEST_SKIP() << "SHERD_TEST_DATA names no folder of meshes";
  std::minstd_rand random(9);
  for (const char* name : {"2CylinderEngine.glb", "CesiumMilkTruck.glb", "Lantern.gltf",
                           "spider.obj", "simple_vase_open.obj", "openscad-nonmanifold-crash.obj",
                           "teapot.stl", "rotatingZone_misoriented.obj", "self_intersectA.obj"}) {
    TriangleMesh mesh = readMesh(std::filesystem::path(folder) / name).mesh;
    const Box box = bounds(mesh);
    const double voxelSize = longestSide(box) / 200.0;
    for (glm::dvec3& v : mesh.vertices) v = (v - box.min) / voxelSize;
    const auto tree = std::make_shared<const TriangleTree>(mesh);
    const GeneralizedWinding winding(mesh, loopCaps(mesh), tree);
    std::size_t wrong = 0;
    for (int i = 0; i < 20000; ++i) {  // beside vertices, where the voxels of the band are
      const glm::dvec3 v = mesh.vertices[random() % mesh.vertices.size()];
      const auto near = [&](double x) {
        return static_cast<int>(std::lround(x)) + static_cast<int>(random() % 7) - 3;
      };
      const openvdb::Coord voxel(near(v.x), near(v.y), near(v.z));
      const double whole = winding.at(voxel);
      const double other = winding.near(glm::dvec3(voxel.x(), voxel.y(), voxel.z()));
      wrong += winding.isInside(voxel) != (whole >= 0.5);
      wrong += (other >= 0.5) != (whole >= 0.5);
      wrong += (std::abs(other - 0.5) > 0.3) != (std::abs(whole - 0.5) > 0.3);
    }
    EXPECT_EQ(wrong, 0u) << name;
  }
}

}  // namespace
}  // namespace sherd
