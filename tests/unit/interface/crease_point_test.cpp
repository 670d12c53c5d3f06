// Points of creases and corners, against planes that determine them.
#include "interface/cells/crease_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <vector>

namespace sherd {
namespace {

TangentPlane through(const glm::dvec3& point, const glm::dvec3& normal) {
  return {point, glm::normalize(normal)};
}

glm::dvec3 meanOf(const std::vector<TangentPlane>& planes) {
  glm::dvec3 sum(0.0);
  for (const TangentPlane& plane : planes) sum += plane.point;
  return sum / static_cast<double>(planes.size());
}

// Whatever the angle, from which 40 degrees count as sharp.
TEST(CreasePoints, TwoPlanesMeetInALine) {
  for (const double degrees : {40.0, 90.0, 150.0}) {
    const double angle = degrees * std::acos(-1.0) / 180.0;
    const glm::dvec3 a(0.0, 1.0, 0.0), b(std::sin(angle), std::cos(angle), 0.0);
    const glm::dvec3 on(0.6, 0.7, 0.0);
    // Points of each plane, off the line by its own direction.
    const std::vector<TangentPlane> planes{through(on + glm::dvec3(-0.4, 0, 0.1), a),
                                           through(on + glm::dvec3(-0.2, 0, 0.9), a),
                                           through(on + 0.3 * glm::cross(b, {0, 0, 1}), b)};
    const glm::dvec3 mean = meanOf(planes);
    const CreasePoint found = creasePoint(planes, mean, cellBox(-5.0));
    EXPECT_EQ(found.rank, 2) << degrees;
    EXPECT_NEAR(found.at.x, on.x, 1e-9);
    EXPECT_NEAR(found.at.y, on.y, 1e-9);
    EXPECT_NEAR(found.at.z, mean.z, 1e-9);  // along the line nothing moves
  }
}

TEST(CreasePoints, ThreePlanesMeetInACorner) {
  const glm::dvec3 corner(0.3, 0.8, 0.4);
  const std::vector<TangentPlane> planes{through(corner + glm::dvec3(0, 0.1, 0.2), {1, 0, 0}),
                                         through(corner + glm::dvec3(0.3, 0, 0.1), {0, 1, 0}),
                                         through(corner + glm::dvec3(-0.5, 0.5, 0), {0, 0, 1})};
  const CreasePoint found = creasePoint(planes, meanOf(planes), cellBox(0.0));
  EXPECT_EQ(found.rank, 3);
  EXPECT_LT(glm::distance(found.at, corner), 1e-9);
  EXPECT_FALSE(found.isClamped);
}

// The edges of a cell meet a ball of ten voxels within a voxel of each other, so its normals differ
// by at most 6 degrees: no crease.
TEST(CreasePoints, OfABallStayAtTheMean) {
  constexpr double kRadius = 10.0;
  std::vector<TangentPlane> planes;
  for (const glm::dvec2 at : {glm::dvec2(0, 0), {1, 0}, {0, 1}, {1, 1}}) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(at.x - 0.5, at.y - 0.5, kRadius));
    planes.push_back({kRadius * normal + glm::dvec3(0.5, 0.5, 0.5 - kRadius), normal});
  }
  const CreasePoint found = creasePoint(planes, meanOf(planes), cellBox(0.0));
  EXPECT_EQ(found.rank, 1);
  EXPECT_EQ(found.at, meanOf(planes));
}

TEST(CreasePoints, StayInTheBox) {
  // A crease along (1, 1, 0) that enters the box only away from the mean.
  const glm::dvec3 along = glm::normalize(glm::dvec3(1, 1, 0)), aside(along.y, -along.x, 0);
  const std::vector<TangentPlane> planes{through({0.2, 0.2, 0.5}, {0, 0, 1}),
                                         through({1.6, 1.6, 0.1}, aside)};
  const glm::dvec3 mean(1.6, 1.4, 0.3);
  const CreasePoint slid = creasePoint(planes, mean, cellBox(0.0));
  EXPECT_NEAR(slid.at.x, 1.0, 1e-9);
  EXPECT_NEAR(slid.at.y, 1.0, 1e-9);
  EXPECT_NEAR(slid.at.z, 0.5, 1e-9);
  EXPECT_FALSE(slid.isClamped);
  // A corner outside.
  const std::vector<TangentPlane> corner{through({1.5, 0, 0}, {1, 0, 0}),
                                         through({0, 0.5, 0}, {0, 1, 0}),
                                         through({0, 0, 0.5}, {0, 0, 1})};
  const CreasePoint clamped = creasePoint(corner, glm::dvec3(0.5), cellBox(0.0));
  EXPECT_LT(glm::distance(clamped.at, {1.0, 0.5, 0.5}), 1e-9);
  EXPECT_TRUE(clamped.isClamped);
}

// Of a crease along an axis at a right angle up to rounding, the entries beside the diagonal of the
// normals' covariance are no numbers to divide by, but more than nothing.
TEST(CreasePoints, AtARightAngleUpToRoundingAreOnBothPlanes) {
  const glm::dvec3 on(0.6, 0.7, 0.2);
  for (int axis = 0; axis < 3; ++axis) {
    for (int step = -40; step <= 40; ++step) {
      for (const double unit : {1e-17, 1e-16, 1e-15, 1e-14, 1e-13}) {
        glm::dvec3 a(0.0), b(0.0);
        a[(axis + 1) % 3] = 1.0;
        a[(axis + 2) % 3] = unit * step;
        b[(axis + 2) % 3] = 1.0;
        b[(axis + 1) % 3] = 0.3 * unit * step;
        const std::vector<TangentPlane> planes{through(on + 0.3 * glm::cross(a, b) + 0.2 * b, a),
                                               through(on + 0.4 * a, b), through(on + 0.1 * a, b)};
        const CreasePoint found = creasePoint(planes, meanOf(planes), cellBox(-5.0));
        ASSERT_EQ(found.rank, 2);
        for (const TangentPlane& plane : planes) {
          ASSERT_LT(std::abs(glm::dot(found.at - plane.point, plane.normal)), 1e-9)
              << axis << ' ' << step << ' ' << unit;
        }
      }
    }
  }
}

}  // namespace
}  // namespace sherd
