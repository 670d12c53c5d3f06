// Measures and topology of meshes against the formulas of ideal shapes.
#include <gtest/gtest.h>
#include <sherd/mesh.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "shapes.h"

namespace sherd {
namespace {

// The tetrahedron with corners 0, ax, by, cz.
TriangleMesh corner(double a, double b, double c) {
  return {{{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TriangleMesh withoutTriangle(TriangleMesh mesh, std::size_t index) {
  mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(index));
  return mesh;
}

TEST(Bounds, HoldsEveryVertex) {
  const Box box = bounds(shapes::cube(2.0, {1.0, 2.0, 3.0}));
  EXPECT_EQ(box.min, glm::dvec3(0.0, 1.0, 2.0));
  EXPECT_EQ(box.max, glm::dvec3(2.0, 3.0, 4.0));
}

TEST(Bounds, OfNothingIsEmpty) { EXPECT_EQ(bounds({}).max, glm::dvec3(0.0)); }

TEST(Volume, OfACubeAndATetrahedronIsExact) {
  EXPECT_DOUBLE_EQ(volume(shapes::cube(3.0, {5.0, -7.0, 11.0})), shapes::cubeVolume(3.0));
  EXPECT_DOUBLE_EQ(volume(corner(2.0, 3.0, 5.0)), 2.0 * 3.0 * 5.0 / 6.0);
}

TEST(Volume, OfAnInvertedMeshIsNegative) {
  EXPECT_DOUBLE_EQ(volume(shapes::inverted(shapes::cube(2.0))), -8.0);
}

TEST(Volume, KeepsItsDigitsFarFromTheOrigin) {
  // The cube's corners are exact at this distance, so that only the sum could lose digits.
  EXPECT_DOUBLE_EQ(volume(shapes::cube(1.0, {1e9, -1e9, 1e9})), 1.0);
}

TEST(Area, OfACubeAndATetrahedronIsExact) {
  EXPECT_DOUBLE_EQ(area(shapes::cube(3.0)), shapes::cubeArea(3.0));
  EXPECT_DOUBLE_EQ(area(corner(1.0, 1.0, 1.0)), 1.5 + std::sqrt(3.0) / 2.0);
}

// An inscribed polyhedron lies below the ideal shape by a share of order (edge / radius)^2, so that
// each refinement divides the error by four.
TEST(Shapes, ConvergeToTheirFormulasAtSecondOrder) {
  const auto expectSecondOrder = [](double coarse, double fine, double ideal) {
    EXPECT_LT(fine, ideal);
    EXPECT_NEAR((ideal - coarse) / (ideal - fine), 4.0, 0.1);
  };
  expectSecondOrder(volume(shapes::ball(2.0, 3)), volume(shapes::ball(2.0, 4)),
                    shapes::ballVolume(2.0));
  expectSecondOrder(area(shapes::ball(2.0, 3)), area(shapes::ball(2.0, 4)), shapes::ballArea(2.0));
  expectSecondOrder(volume(shapes::torus(3.0, 1.0, 48, 24)),
                    volume(shapes::torus(3.0, 1.0, 96, 48)), shapes::torusVolume(3.0, 1.0));
  expectSecondOrder(area(shapes::torus(3.0, 1.0, 48, 24)), area(shapes::torus(3.0, 1.0, 96, 48)),
                    shapes::torusArea(3.0, 1.0));
  expectSecondOrder(volume(shapes::cup(2.0, 0.5, 3.0, 0.4, 48)),
                    volume(shapes::cup(2.0, 0.5, 3.0, 0.4, 96)),
                    shapes::cupVolume(2.0, 0.5, 3.0, 0.4));
  expectSecondOrder(area(shapes::cup(2.0, 0.5, 3.0, 0.4, 48)),
                    area(shapes::cup(2.0, 0.5, 3.0, 0.4, 96)), shapes::cupArea(2.0, 0.5, 3.0, 0.4));
  expectSecondOrder(volume(shapes::hollowBall(2.0, 1.0, 3)),
                    volume(shapes::hollowBall(2.0, 1.0, 4)), shapes::hollowBallVolume(2.0, 1.0));
  expectSecondOrder(area(shapes::hollowBall(2.0, 1.0, 3)), area(shapes::hollowBall(2.0, 1.0, 4)),
                    shapes::hollowBallArea(2.0, 1.0));
}

TEST(Shapes, AreClosedAndManifold) {
  for (const TriangleMesh& mesh : {shapes::cube(1.0), shapes::ball(1.0, 2), shapes::torus(3.0, 1.0),
                                   shapes::cup(2.0, 0.5, 3.0, 0.4), shapes::hollowBall(2.0, 1.0)}) {
    EXPECT_EQ(openEdges(mesh), 0u);
    EXPECT_EQ(nonManifoldEdges(mesh), 0u);
  }
}

TEST(Shapes, MoveAndScaleTheirVolume) {
  const TriangleMesh cup = shapes::cup(2.0, 0.5, 3.0, 0.4);
  EXPECT_NEAR(volume(shapes::transformed(cup, 2.0, {1.0, 2.0, 3.0})), 8.0 * volume(cup),
              1e-12 * volume(cup));
}

void expectNear(const glm::dmat3& a, const glm::dmat3& b, double tolerance) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(a[i][j], b[i][j], tolerance) << i << ' ' << j;
}

TEST(MassProperties, OfABoxAreExact) {
  TriangleMesh box = shapes::cube(1.0);
  for (glm::dvec3& v : box.vertices)
    v = v * glm::dvec3(1.0, 2.0, 3.0) + glm::dvec3(10.0, 20.0, 30.0);
  const MassProperties mass = massProperties(box);
  EXPECT_NEAR(mass.volume, 6.0, 1e-12);
  EXPECT_LT(glm::distance(mass.centroid, glm::dvec3(10.0, 20.0, 30.0)), 1e-12);
  expectNear(mass.inertia, 6.0 / 12.0 * glm::dmat3(4 + 9, 0, 0, 0, 1 + 9, 0, 0, 0, 1 + 4), 1e-12);
}

TEST(MassProperties, OfATetrahedronAreExact) {
  // Integrals over the corner tetrahedron with edges a, b, c and volume V: x -> V a/4, x^2 -> V
  // a^2/10, xy -> V ab/20; about the centroid: x^2 -> 3 V a^2/80, xy -> -V ab/80.
  const double a = 2.0, b = 3.0, c = 5.0, V = a * b * c / 6.0;
  const MassProperties mass = massProperties(corner(a, b, c));
  EXPECT_NEAR(mass.volume, V, 1e-14);
  EXPECT_LT(glm::distance(mass.centroid, glm::dvec3(a, b, c) / 4.0), 1e-14);
  const glm::dvec3 s = 3.0 * V / 80.0 * glm::dvec3(a * a, b * b, c * c);
  const double xy = -V * a * b / 80.0, yz = -V * b * c / 80.0, zx = -V * c * a / 80.0;
  expectNear(mass.inertia,
             glm::dmat3(s.y + s.z, -xy, -zx, -xy, s.z + s.x, -yz, -zx, -yz, s.x + s.y), 1e-13);
}

TEST(MassProperties, OfABallAreTheSameAboutEveryAxis) {
  const MassProperties mass = massProperties(shapes::ball(2.0, 5, {1.0, 2.0, 3.0}));
  const double missing =
      1.0 - mass.volume / shapes::ballVolume(2.0);  // share that the polyhedron lacks
  EXPECT_LT(missing, 1e-3);
  EXPECT_LT(glm::distance(mass.centroid, glm::dvec3(1.0, 2.0, 3.0)), 1e-13);
  // 2/5 m r^2; what the polyhedron lacks lies at the surface, where 2/3 r^2 of inertia goes with
  // each unit of volume.
  const double ideal = 2.0 / 5.0 * shapes::ballVolume(2.0) * 4.0;
  expectNear(mass.inertia, glm::dmat3(ideal * (1.0 - missing * 5.0 / 3.0)),
             ideal * missing * missing * 10.0);
}

TEST(MassProperties, OfAHollowBallAreThoseOfTheDifference) {
  const MassProperties outer = massProperties(shapes::ball(2.0, 3));
  const MassProperties inner = massProperties(shapes::ball(1.0, 3));
  const MassProperties hollow = massProperties(shapes::hollowBall(2.0, 1.0, 3));
  EXPECT_NEAR(hollow.volume, outer.volume - inner.volume, 1e-12);
  expectNear(hollow.inertia, outer.inertia - inner.inertia, 1e-12);
}

TEST(MassProperties, MoveWithTheMeshToTheBit) {
  const TriangleMesh cube = shapes::cube(1.0);
  const MassProperties here = massProperties(cube);
  const MassProperties there =
      massProperties(shapes::transformed(cube, 1.0, {1024.0, -512.0, 256.0}));
  EXPECT_EQ(there.volume, here.volume);
  EXPECT_EQ(there.inertia, here.inertia);
  EXPECT_EQ(there.centroid, here.centroid + glm::dvec3(1024.0, -512.0, 256.0));
}

TEST(OpenEdges, AreThoseAroundAHole) {
  EXPECT_EQ(openEdges(withoutTriangle(shapes::cube(1.0), 5)), 3u);
  EXPECT_EQ(openEdges({}), 0u);
}

TEST(OpenEdges, CountAFlippedTriangle) {
  TriangleMesh cube = shapes::cube(1.0);
  std::swap(cube.triangles[5].x, cube.triangles[5].y);
  EXPECT_EQ(openEdges(cube), 3u);
}

// Two tetrahedra on both sides of one common edge, 0-1.
TriangleMesh touchingAtAnEdge() {
  TriangleMesh mesh = corner(1.0, 1.0, 1.0);  // edge 0-1 along x
  mesh.vertices.insert(mesh.vertices.end(), {{0, -1, 0}, {0, 0, -1}});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 4, 1}, {0, 1, 5}, {0, 5, 4}, {1, 4, 5}});
  return mesh;
}

TEST(OpenEdges, LeaveOutSheetsThatTouchAtAnEdge) {
  const TriangleMesh mesh = touchingAtAnEdge();
  EXPECT_EQ(openEdges(mesh), 0u);
  EXPECT_EQ(nonManifoldEdges(mesh), 1u);
}

TEST(NonManifoldEdges, CountOpenEdgesToo) {
  EXPECT_EQ(nonManifoldEdges(withoutTriangle(shapes::cube(1.0), 0)), 3u);
}

TEST(MeshComponents, AreNumberedByTheirFirstTriangle) {
  const TriangleMesh two = shapes::append(shapes::cube(1.0), shapes::ball(1.0, 1, {5.0, 0.0, 0.0}));
  const MeshComponents found = meshComponents(two);
  EXPECT_EQ(found.count, 2u);
  ASSERT_EQ(found.ofTriangle.size(), two.triangles.size());
  for (std::size_t i = 0; i < found.ofTriangle.size(); ++i)
    EXPECT_EQ(found.ofTriangle[i], i < 12 ? 0u : 1u);
}

TEST(MeshComponents, HoldTogetherOverASingleVertex) {
  const TriangleMesh bowTie{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
                            {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_EQ(meshComponents(bowTie).count, 1u);
  EXPECT_EQ(meshComponents({}).count, 0u);
}

}  // namespace
}  // namespace sherd
