// Figures of a fracture against mathematics.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <vector>

#include "shapes.h"

namespace sherd {
namespace {

constexpr double kPushOfBox = 1e-4 * 2.0 * 1.7320508075688772;  // of the box from -1 to 1

// A parallelogram with vertices of its own, so that its normals are the face's; it faces u x v.
void addQuad(TriangleMesh& mesh, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
  const auto first = static_cast<unsigned>(mesh.vertices.size());
  for (const glm::dvec3& p : {corner, corner + u, corner + u + v, corner + v}) {
    mesh.vertices.push_back(p);
  }
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

// A corner bracket of height 1 on the section below, made of 14 unit squares: 3 on either end, 8
// round the side.  The hull adds the triangle that the dashes cut off, x + y <= 3.
//
//     2 +----+
//       |    | .
//     1 |    +----+
//       |         |
//     0 +----+----+
//       0    1    2
TriangleMesh bracket() {
  const glm::dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  TriangleMesh mesh;
  for (const glm::dvec3& square : {0.0 * x, x, y}) {
    addQuad(mesh, square, y, x);
    addQuad(mesh, square + z, x, y);
  }
  const std::vector<std::pair<glm::dvec3, glm::dvec3>> walk{
      {0.0 * x, x},      {x, x},        {2.0 * x, y}, {2.0 * x + y, -x}, {x + y, y},
      {x + 2.0 * y, -x}, {2.0 * y, -y}, {y, -y}};
  for (const auto& [from, along] : walk) addQuad(mesh, from, along, z);
  return mesh;
}

// What the bracket's coordinates are divided by.
double largestCoordinate(const TriangleMesh& mesh) {
  const glm::dvec3 mean =
      std::accumulate(mesh.vertices.begin(), mesh.vertices.end(), glm::dvec3(0.0)) /
      static_cast<double>(mesh.vertices.size());
  double largest = 0.0;
  for (const glm::dvec3& v : mesh.vertices) {
    const glm::dvec3 a = glm::abs(v - mean);
    largest = std::max({largest, a.x, a.y, a.z});
  }
  return largest;
}

ErrorCode refusal(const TriangleMesh& mesh, std::size_t samples = 100) {
  try {
    (void)convexity(mesh, samples);
  } catch (const Error& e) {
    EXPECT_GT(std::string(e.what()).size(), 8u);
    return e.code();
  }
  return ErrorCode::internal;
}

// A point of a convex surface is where the ray from the point below it leaves the hull, whatever
// the direction of the push.  The push is that of the samples' box: it is the whole box here, as
// every face has samples; and the cube's normals point from the center, so none is lost.
TEST(Convexity, OfACubeIsOneLessThePush) {
  const Convexity found = convexity(shapes::cube(3.0, {1.0, 2.0, -5.0}));
  EXPECT_EQ(found.samples, 5000u);
  EXPECT_NEAR(found.value, 1.0 - kPushOfBox, 1e-12);
  EXPECT_LT(found.standardDeviation, 1e-12);
}

// As the cube; but the samples' box only comes near the ball's.  A cap that rises h above the rest
// holds h / 2 of a sphere's area: all of 5000 samples miss one of 0.02 in exp(-50).
TEST(Convexity, OfABallIsOneLessThePush) {
  const Convexity found = convexity(shapes::ball(2.0, 5, {7.0, 0.0, 0.0}));
  EXPECT_EQ(found.samples, 5000u);
  EXPECT_GE(found.value, 1.0 - kPushOfBox);
  EXPECT_LE(found.value, 1.0 - 0.98 * kPushOfBox);
  EXPECT_LT(found.standardDeviation, 1e-9);
}

// All faces but the two of the notch lie on the hull.  From the face x = 1 at height y, 1..2, the
// way along +x to x + y = 3 is 2 - y: uniform in 0..1; so it is from y = 1.  The distance X is thus
// uniform in 0..1 on 2 of 14 units of area and 0 elsewhere: E X^k = 1 / (7 (k + 1)).  All is
// divided by the largest coordinate; the push adds the same to each.
TEST(Convexity, OfABracketIsTheOneComputed) {
  const TriangleMesh mesh = bracket();
  ASSERT_DOUBLE_EQ(area(mesh), 14.0);
  ASSERT_DOUBLE_EQ(volume(mesh), 3.0);
  const double scale = largestCoordinate(mesh);
  const double m1 = 1.0 / 14, m2 = 1.0 / 21, m3 = 1.0 / 28, m4 = 1.0 / 35;
  const double variance = m2 - m1 * m1;
  const double fourth = m4 - 4 * m1 * m3 + 6 * m1 * m1 * m2 - 3 * m1 * m1 * m1 * m1;
  const double push = 1e-4 * 3.0;  // the box is 2 x 2 x 1
  constexpr std::size_t kSamples = 20000;
  const double n = kSamples;
  for (const std::uint64_t seed : {0u, 1u, 2u}) {
    const Convexity found = convexity(mesh, kSamples, seed);
    EXPECT_GE(found.samples, kSamples - 5);  // single precision may lose one at an edge
    EXPECT_NEAR(found.value, 1.0 - (m1 + push) / scale, 5.0 * std::sqrt(variance / n) / scale);
    EXPECT_NEAR(found.standardDeviation, std::sqrt(variance) / scale,
                5.0 * std::sqrt((fourth - variance * variance) / (4.0 * variance * n)) / scale);
  }
}

// From the cavity of radius r the ray goes through the center and out: r + R, in units of R.  The
// rest of the surface lies on the hull.  Facets of edges up to e = 0.083 lie e^2 / 6 = 0.0012
// inside the unit sphere, which takes less than 2 * 0.0012 off a fifth of the distances: under
// 0.001.
TEST(Convexity, OfAHollowBallIsTheOneComputed) {
  const double R = 1.0, r = 0.5;
  const double share = r * r / (R * R + r * r), far = (R + r) / R;
  const Convexity found = convexity(shapes::hollowBall(R, r, 4), 20000);
  const double deviation = far * std::sqrt(share * (1.0 - share));
  EXPECT_NEAR(found.value, 1.0 - share * far - kPushOfBox,
              5.0 * deviation / std::sqrt(20000.0) + 0.001);
  EXPECT_NEAR(found.standardDeviation, deviation, 0.02);  // 5 times its own error is 0.016
}

TEST(Convexity, DoesNotDependOnPlaceOrSize) {
  const TriangleMesh cup = shapes::cup(1.0, 0.2, 2.0, 0.3);
  const Convexity here = convexity(cup);
  EXPECT_LT(here.value, 0.9);
  for (const double scale : {0.001, 0.37, 64.0, 1e6}) {
    const Convexity there =
        convexity(shapes::transformed(cup, scale, scale * glm::dvec3(3, -7, 11)));
    EXPECT_EQ(there.samples, here.samples);
    EXPECT_NEAR(there.value, here.value, 1e-9);
    EXPECT_NEAR(there.standardDeviation, here.standardDeviation, 1e-9);
  }
}

TEST(Convexity, FollowsFromTheSeedAlone) {
  const TriangleMesh mesh = shapes::torus(1.0, 0.3);
  const Convexity once = convexity(mesh, 2000, 4);
  Convexity again;
  tbb::task_arena alone(1);
  alone.execute([&] { again = convexity(mesh, 2000, 4); });
  EXPECT_EQ(once.value, again.value);
  EXPECT_EQ(once.standardDeviation, again.standardDeviation);
  EXPECT_EQ(once.samples, again.samples);
  EXPECT_NE(once.value, convexity(mesh, 2000, 5).value);
}

TEST(Convexity, RefusesWhatHasNoInside) {
  EXPECT_EQ(refusal(shapes::cube(1.0), 0), ErrorCode::usage);
  EXPECT_EQ(refusal({}), ErrorCode::input);
  EXPECT_EQ(refusal({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}}), ErrorCode::input);
  EXPECT_EQ(refusal({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}}), ErrorCode::input);
  EXPECT_EQ(refusal({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 1, 0}},
                     {{0, 1, 2}, {0, 2, 3}, {1, 4, 2}}}),
            ErrorCode::input);
  EXPECT_EQ(refusal({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {1, 2, 3}}}),
            ErrorCode::input);
  EXPECT_EQ(refusal(shapes::inverted(shapes::cube(1.0))), ErrorCode::input);
}

TEST(EffectiveCount, CountsEqualSharesAndLeavesSmallOnesOut) {
  EXPECT_DOUBLE_EQ(effectiveCount(std::vector<double>(7, 1.0 / 7)), 7.0);
  EXPECT_DOUBLE_EQ(effectiveCount(std::vector<double>(7, 0.1)), 7.0);  // worn: shares below 1
  EXPECT_DOUBLE_EQ(effectiveCount(std::vector<double>{1.0, 0.0, 0.0}), 1.0);
  EXPECT_DOUBLE_EQ(effectiveCount(std::vector<double>{0.5, 0.25, 0.25}), 1.0 / 0.375);
  EXPECT_EQ(effectiveCount({}), 0.0);
}

}  // namespace
}  // namespace sherd
