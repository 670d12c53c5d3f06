// The surfaces of given cracks: distances and sides against those of planes, cones and another
// program's signs.
#include "pipeline/guide_surfaces.h"

#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/points.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/random.h"
#include "grow/splits/guide_sides.h"
#include "kernels/voxel_shapes.h"
#include "mesh/search/curtain.h"
#include "mesh/search/sided_mesh.h"
#include "shapes.h"

namespace sherd {
namespace {

constexpr double kPi = std::numbers::pi;

// Points of the cube -half..half.
std::vector<glm::dvec3> randomPoints(std::size_t count, double half) {
  std::vector<glm::dvec3> points;
  for (std::uint64_t i = 0; i < count; ++i) {
    glm::dvec3 unit;
    for (int axis = 0; axis < 3; ++axis) {
      unit[axis] = randomUnit(7, Stage::seedPoint, 3 * i + static_cast<std::uint64_t>(axis));
    }
    points.push_back(half * (2.0 * unit - 1.0));
  }
  return points;
}

// A square of the plane z = 0, its normal upwards, in cells of different shapes.
TriangleMesh square(double half) {
  TriangleMesh mesh;
  constexpr std::uint32_t kCells = 5;
  for (std::uint32_t y = 0; y <= kCells; ++y) {
    for (std::uint32_t x = 0; x <= kCells; ++x) {
      mesh.vertices.push_back(
          {half * (2.0 * x / kCells - 1.0), half * (2.0 * y / kCells - 1.0), 0});
      if (x == kCells || y == kCells) continue;
      const std::uint32_t a = y * (kCells + 1) + x, b = a + 1, c = a + kCells + 1, d = c + 1;
      mesh.triangles.push_back({a, b, (x + y) % 2 == 0 ? d : c});
      mesh.triangles.push_back((x + y) % 2 == 0 ? glm::uvec3{a, d, c} : glm::uvec3{b, d, c});
    }
  }
  return mesh;
}

// A cylinder about the z axis, |z| <= half.
TriangleMesh cylinder(double radius, double half, std::uint32_t sides) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2.0 * kPi * i / sides;
    for (const double z : {-half, half}) {
      mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % sides);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    mesh.triangles.push_back({2 * sides, b, a});
    mesh.triangles.push_back({2 * sides + 1, a + 1, b + 1});
  }
  mesh.vertices.push_back({0, 0, -half});
  mesh.vertices.push_back({0, 0, half});
  return mesh;
}

std::vector<glm::dvec3> circle(double radius, double z, double from, double to, int points) {
  std::vector<glm::dvec3> line;
  for (int i = 0; i <= points; ++i) {
    const double angle = from + (to - from) * i / points;
    line.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  return line;
}

TEST(SidedMesh, OfAPlanarPatchIsThePlane) {
  const SidedMesh patch(square(1.0));
  EXPECT_FALSE(patch.isClosed());
  for (const glm::dvec3& p : randomPoints(2000, 3.0)) {
    EXPECT_NEAR(patch.signedDistance(p), p.z, 1e-12);
  }
}

// Its signs come from rays and solid angles.
TEST(SidedMesh, OfAClosedMeshAgreesWithItsInside) {
  const TriangleMesh cup = shapes::cup(1.0, 0.2, 1.5, 0.2, 48);
  const SidedMesh sided(cup);
  EXPECT_TRUE(sided.isClosed());
  const std::vector<glm::dvec3> points = randomPoints(3000, 1.6);
  const std::vector<double> distances = signedDistances(cup, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(sided.signedDistance(points[i]), distances[i], 1e-9) << i;
  }
}

TEST(SidedMesh, OfASphereIsTheDistanceToIt) {
  const TriangleMesh mesh = shapes::ball(1.0, 4);
  double deepest = 0.0;  // of the triangles' planes below the sphere
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 &a = mesh.vertices[t.x], &b = mesh.vertices[t.y], &c = mesh.vertices[t.z];
    deepest = std::max(deepest, 1.0 - glm::dot(a, glm::normalize(glm::cross(b - a, c - a))));
  }
  EXPECT_LT(deepest, 0.002);
  const SidedMesh ball(mesh);
  for (const glm::dvec3& p : randomPoints(1000, 1.5)) {
    const double distance = ball.signedDistance(p), exact = glm::length(p) - 1.0;
    EXPECT_GE(distance, exact - 1e-12);
    EXPECT_LE(distance, exact + deepest + 1e-12);
  }
}

// The plane of the circle, also where the curtain ends: at nine tenths of the way to the axis.
TEST(Curtain, OfACircleAroundACylinderIsItsPlane) {
  const DrawnSurface surface(cylinder(1.0, 1.5, 64));
  // Its chords are left for the surface: the line is drawn with few points.
  const SidedMesh curtain(curtainOf(circle(1.0, 0.3, 0.0, 2.0 * kPi, 12), surface));
  const double side = curtain.signedDistance({0.9, 0.0, 1.0}) > 0.0 ? 1.0 : -1.0;
  for (const glm::dvec3& p : randomPoints(2000, 1.5)) {
    EXPECT_NEAR(side * curtain.signedDistance(p), p.z - 0.3, 1e-9);
  }
}

TEST(Curtain, OfAnArcIsContinuedBeyondItsEnds) {
  const DrawnSurface surface(cylinder(1.0, 1.5, 64));
  const SidedMesh curtain(curtainOf(circle(1.0, -0.2, 0.4, 1.9, 8), surface));
  const double side = curtain.signedDistance({0.0, 0.9, 1.0}) > 0.0 ? 1.0 : -1.0;
  for (const glm::dvec3& p : randomPoints(2000, 1.5)) {
    EXPECT_NEAR(side * curtain.signedDistance(p), p.z + 0.2, 1e-9);
  }
}

// How triangles are ordered and bounded changes no distance, nor does a guess.
TEST(Curtain, AsAStripHasTheDistancesOfItsTriangles) {
  const DrawnSurface surface(shapes::ball(1.0, 4));
  std::vector<glm::dvec3> line = randomPoints(20, 1.0);
  for (glm::dvec3& p : line) p = glm::normalize(p);
  const TriangleMesh mesh = curtainOf(line, surface);
  for (const glm::dvec3 offset : {glm::dvec3(0.0), glm::dvec3(1e5, -3e4, 0.0)}) {
    TriangleMesh moved = mesh;
    for (glm::dvec3& v : moved.vertices) v += offset;
    const TriangleTree any(moved), strip = TriangleTree::ofStrip(moved);
    std::uint32_t guess = TriangleTree::kNone;
    for (const glm::dvec3& p : randomPoints(2000, 2.0)) {
      const TriangleTree::Nearest nearest = strip.nearest(p + offset, 1e9, guess);
      EXPECT_EQ(nearest.distance, any.nearest(p + offset, 1e9).distance);
      EXPECT_EQ(std::sqrt(strip.squaredTo(p + offset, nearest.triangle)), nearest.distance);
      guess = nearest.triangle;
    }
  }
}

// Normals of a ball pass through its middle: a circle's curtain is a cone with its tip there.
TEST(Curtain, OfACircleOnABallIsACone) {
  const DrawnSurface surface(shapes::ball(1.0, 5));
  const double opening = 0.7;  // from the z axis
  const SidedMesh curtain(
      curtainOf(circle(std::sin(opening), std::cos(opening), 0.0, 2.0 * kPi, 200), surface));
  const double side = curtain.signedDistance({0.0, 0.0, 1.0}) > 0.0 ? 1.0 : -1.0;
  int measured = 0;
  for (const glm::dvec3& p : randomPoints(4000, 1.0)) {
    const double r = glm::length(p), angle = std::acos(p.z / r);
    // Beside the cone, above the tenth that is left out at the tip.
    const double along = r * std::cos(angle - opening);
    if (r > 1.0 || along < 0.15 || along > 0.95 || std::abs(angle - opening) > 1.0) continue;
    ++measured;
    // Normals that are interpolated between vertices 0.035 apart are off by 0.035^2 / 2 at most.
    EXPECT_NEAR(side * curtain.signedDistance(p), -r * std::sin(angle - opening), 0.001);
  }
  EXPECT_GT(measured, 500);
}

// The wall of a cup is cut at right angles, and the opposite wall is not cut.
TEST(Curtain, OfARingDrawnOnAWallCutsOnlyThatWall) {
  const double wall = 0.1;
  const DrawnSurface surface(shapes::cup(1.0, wall, 2.0, wall, 128));
  std::vector<glm::dvec3> ring;  // of radius 0.3 about (1, 0, 1), on the outside
  for (int i = 0; i <= 100; ++i) {
    const double turn = 2.0 * kPi * i / 100, along = 0.3 * std::cos(turn);
    ring.push_back({std::cos(along), std::sin(along), 1.0 + 0.3 * std::sin(turn)});
  }
  ring.back() = ring.front();
  const SidedMesh curtain(curtainOf(ring, surface));
  const double side = curtain.signedDistance({0.95, 0.0, 1.0}) > 0.0 ? 1.0 : -1.0;
  for (int i = 0; i < 4000; ++i) {
    const double angle = kPi * (2.0 * randomUnit(1, Stage::seedPoint, 3 * i) - 1.0);
    const double depth = wall * randomUnit(1, Stage::seedPoint, 3 * i + 1);
    const double z = wall + (2.0 - wall) * randomUnit(1, Stage::seedPoint, 3 * i + 2);
    const double off = std::hypot(angle, z - 1.0) - 0.3;  // unrolled
    if (std::abs(off) < 0.02) continue;
    const glm::dvec3 at((1.0 - depth) * std::cos(angle), (1.0 - depth) * std::sin(angle), z);
    EXPECT_EQ(side * curtain.signedDistance(at) > 0.0, off < 0.0) << angle << " " << z;
  }
}

// A line that is drawn within a wall, nearer to one side here and to the other there, is no other
// one than on a side.
TEST(Curtain, OfALineWithinAWallStaysOnOneSide) {
  const double wall = 0.1;
  const DrawnSurface surface(shapes::cup(1.0, wall, 2.0, wall, 128));
  std::vector<glm::dvec3> ring;
  for (int i = 0; i <= 100; ++i) {
    const double angle = 2.0 * kPi * i / 100,
                 radius = 1.0 - wall * (0.5 + 0.3 * std::cos(7 * angle));
    ring.push_back({radius * std::cos(angle), radius * std::sin(angle), 1.0});
  }
  const SidedMesh curtain(curtainOf(ring, surface));
  const double side = curtain.signedDistance({0.95, 0.0, 1.5}) > 0.0 ? 1.0 : -1.0;
  for (const glm::dvec3& p : randomPoints(1000, 1.0)) {
    EXPECT_NEAR(side * curtain.signedDistance(p + glm::dvec3(0, 0, 1)), p.z, 1e-9);
  }
}

TEST(Curtain, RefusesLinesThatAreNone) {
  const DrawnSurface surface(cylinder(1.0, 1.5, 64));
  const std::vector<glm::dvec3> point(3, glm::dvec3(1, 0, 0)), far{{9, 0, 0}, {9, 1, 0}};
  EXPECT_THROW((void)curtainOf(point, surface), Error);
  EXPECT_THROW((void)curtainOf(far, surface), Error);
}

TEST(GuideSides, EqualTheSideOfEachVoxel) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::ball(20));
  const GridFrame frame{{0.3, -0.2, 5.0}, 0.1};
  const glm::dvec3 middle = frame.worldFromIndex(glm::dvec3(0.0));
  for (const TriangleMesh& mesh :
       {shapes::ball(1.1, 3, middle), shapes::transformed(square(0.7), 1.0, middle + 0.05),
        shapes::cube(2.0, middle + 0.4)}) {
    const SidedMesh surface(mesh);
    const std::vector<std::uint64_t> positive = positiveSide(*blocks, frame, surface);
    ASSERT_EQ(positive.size(), blocks->inside.size());
    std::size_t inside = 0, set = 0;
    blocks->forEachInside([&](std::size_t voxel) {
      const bool isPositive = (positive[voxel / 64] >> (voxel % 64)) & 1;
      const double distance = surface.signedDistance(frame.worldFromIndex(blocks->voxelAt(voxel)));
      EXPECT_EQ(isPositive, distance > 0.0) << voxel;
      ++inside;
      set += isPositive ? 1 : 0;
    });
    EXPECT_GT(set, inside / 20);
    EXPECT_LT(set, inside);
    for (std::size_t word = 0; word < positive.size(); ++word) {
      EXPECT_EQ(positive[word] & ~blocks->inside[word], 0u);
    }
  }
}

TEST(GuideSides, StopWhenCancelled) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::ball(20));
  const Progress progress{.report = {}, .cancelled = [] { return true; }};
  EXPECT_THROW((void)positiveSide(*blocks, {}, SidedMesh(square(1.0)), &progress), Error);
}

TEST(GuideSurfaces, AreOnePerLineAndComponent) {
  const Solid solid = voxelize(shapes::ball(1.0, 4), {.resolution = 24});
  Guide guide{.file = "cracks.obj"};
  guide.polylines.push_back(circle(1.0, 0.0, 0.0, 2.0, 20));
  guide.polylines.push_back(circle(0.8, 0.6, 0.0, 1.0, 20));
  guide.mesh = shapes::append(shapes::cube(0.5), shapes::inverted(shapes::cube(0.2, {2, 0, 0})));
  EXPECT_EQ(guideSurfacesOf(std::span(&guide, 1), solid).surfaces.size(), 4u);
  const auto refusal = [&](const Guide& bad) {
    try {
      (void)guideSurfacesOf(std::span(&bad, 1), solid);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal({.file = "a.obj"}), "a.obj: has neither lines nor triangles");
  EXPECT_EQ(refusal({.file = "a.obj", .polylines = {{glm::dvec3(0.0)}}}),
            "a.obj: has a line of less than two points");
  EXPECT_EQ(refusal({.file = "a.obj", .polylines = {{glm::dvec3(NAN), glm::dvec3(0.0)}}}),
            "a.obj: has a coordinate that is not finite");
  EXPECT_NE(refusal({.file = "a.obj", .polylines = {{glm::dvec3(50.0), glm::dvec3(60.0)}}}), "");
  EXPECT_NE(refusal({.file = "a.obj",
                     .mesh = {{glm::dvec3(0.0), glm::dvec3(1.0), glm::dvec3(2.0)}, {{0, 1, 2}}}}),
            "");
}

}  // namespace
}  // namespace sherd
