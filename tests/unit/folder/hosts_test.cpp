// What stands behind files for hosts: principal axes, hulls as meshes.
#include <gtest/gtest.h>
#include <sherd/error.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>

#include "mesh/hull.h"
#include "mesh/principal_inertia.h"
#include "mesh_checks.h"
#include "shapes.h"

namespace sherd {
namespace {

// A box with sides 1, 2, 3, turned.
TriangleMesh turnedBox(const glm::dmat3& turn, const glm::dvec3& center) {
  TriangleMesh mesh = shapes::cube(1.0);
  for (glm::dvec3& v : mesh.vertices) v = turn * (v * glm::dvec3(1, 2, 3)) + center;
  return mesh;
}

glm::dmat3 someTurn() {
  return glm::dmat3(glm::rotate(glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(0, 0, 1)), -1.1,
                                glm::normalize(glm::dvec3(1, 2, 0))));
}

TEST(PrincipalInertia, FindsTheAxesOfATurnedBox) {
  const PrincipalInertia found =
      principalInertia(massProperties(turnedBox(someTurn(), {5.0, -3.0, 2.0})));
  std::vector<double> moments{found.moments.x, found.moments.y, found.moments.z};
  std::sort(moments.begin(), moments.end());
  // m (b^2 + c^2) / 12 with m = 6
  EXPECT_NEAR(moments[0], 0.5 * (1 + 4), 1e-9);
  EXPECT_NEAR(moments[1], 0.5 * (1 + 9), 1e-9);
  EXPECT_NEAR(moments[2], 0.5 * (4 + 9), 1e-9);
  const glm::dmat3 axes = glm::mat3_cast(found.orientation);
  EXPECT_NEAR(glm::determinant(axes), 1.0, 1e-12);
  glm::dmat3 diagonal(0.0);
  for (int k = 0; k < 3; ++k) diagonal[k][k] = found.moments[k];
  const glm::dmat3 back = axes * diagonal * glm::transpose(axes);
  const glm::dmat3 inertia = massProperties(turnedBox(someTurn(), {5.0, -3.0, 2.0})).inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(back[i][j], inertia[i][j], 1e-9);
  }
}

TEST(ConvexHullMesh, IsTheBodyItselfWhereThatIsConvex) {
  const TriangleMesh box = turnedBox(someTurn(), {5.0, -3.0, 2.0});
  std::vector<glm::dvec3> points = box.vertices;
  points.push_back({5.0, -3.0, 2.0});  // inside
  const TriangleMesh hull = convexHullMesh(points);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.triangles.size(), 12u);
  EXPECT_NEAR(volume(hull), 6.0, 1e-9);
  EXPECT_NEAR(area(hull), 22.0, 1e-9);
  expectClosedManifold(hull);

  const TriangleMesh ball = shapes::ball(1.0, 3);
  const TriangleMesh ballHull = convexHullMesh(ball.vertices);
  EXPECT_EQ(ballHull.triangles.size(), ball.triangles.size());
  EXPECT_NEAR(volume(ballHull), volume(ball), 1e-9);
  expectClosedManifold(ballHull);
}

TEST(ConvexHullMesh, IsInsetOnEverySide) {
  const TriangleMesh box = turnedBox(someTurn(), {5.0, -3.0, 2.0});
  const TriangleMesh inset = convexHullMesh(box.vertices, 0.1);
  EXPECT_NEAR(volume(inset), 0.8 * 1.8 * 2.8, 1e-9);
  expectClosedManifold(inset);
  // No farther than half of what there is: half a side of the shortest, so half its length is left.
  EXPECT_NEAR(volume(convexHullMesh(box.vertices, 10.0)), 0.5 * 1.5 * 2.5, 1e-9);
}

TEST(ConvexHullMesh, RefusesAFlatBody) {
  EXPECT_THROW((void)convexHullMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), Error);
  EXPECT_THROW((void)convexHullMesh({{0, 0, 0}}), Error);
}

}  // namespace
}  // namespace sherd
