// What is counted on meshes with known faults.
#include <gtest/gtest.h>
#include <sherd/evaluate.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "shapes.h"

namespace sherd {
namespace {

/// Vertices at one place made one.
TriangleMesh welded(const TriangleMesh& mesh) {
  TriangleMesh result;
  std::map<std::tuple<double, double, double>, unsigned> numbers;
  std::vector<unsigned> number;
  for (const glm::dvec3& v : mesh.vertices) {
    const auto [at, fresh] = numbers.try_emplace({v.x, v.y, v.z}, result.vertices.size());
    if (fresh) result.vertices.push_back(v);
    number.push_back(at->second);
  }
  for (const glm::uvec3& t : mesh.triangles) {
    result.triangles.emplace_back(number[t.x], number[t.y], number[t.z]);
  }
  return result;
}

std::size_t faults(const MeshQuality& q) {
  return q.boundaryEdges + q.nonManifoldEdges + q.flippedEdges + q.nonManifoldVertices +
         q.degenerateTriangles + q.duplicateTriangles;
}

// Half squares: 45, 45 and 90 degrees.
TEST(MeshQuality, OfACubeHasNoFault) {
  const MeshQuality q = meshQuality(shapes::cube(2.0, {5.0, 0.0, 0.0}));
  EXPECT_EQ(faults(q), 0u);
  EXPECT_TRUE(q.closed && q.manifold() && q.outward());
  EXPECT_EQ(std::tuple(q.vertices, q.triangles, q.components), std::tuple(8u, 12u, 1u));
  EXPECT_NEAR(q.smallestAngle, 45.0, 1e-9);
  EXPECT_NEAR(q.meanSmallestAngle, 45.0, 1e-9);
  EXPECT_EQ(q.smallestAngles[8] + q.smallestAngles[9], 12u);
  EXPECT_EQ(q.sliverShare, 0.0);
  EXPECT_NEAR(q.volume, 8.0, 1e-9);
}

TEST(MeshQuality, KnowsWhatIsTurnedOver) {
  const MeshQuality q = meshQuality(shapes::inverted(shapes::cube(1.0)));
  EXPECT_TRUE(q.closed && q.manifold());
  EXPECT_FALSE(q.outward());
}

TEST(MeshQuality, CountsTheEdgesOfAHole) {
  TriangleMesh mesh = shapes::cube(1.0);
  mesh.triangles.pop_back();
  const MeshQuality q = meshQuality(mesh);
  EXPECT_EQ(q.boundaryEdges, 3u);
  EXPECT_EQ(faults(q), 3u);
  EXPECT_FALSE(q.closed || q.outward() || q.manifold());
}

TEST(MeshQuality, CountsTheEdgesOfAFlippedTriangle) {
  TriangleMesh mesh = shapes::cube(1.0);
  std::swap(mesh.triangles[3].x, mesh.triangles[3].y);
  const MeshQuality q = meshQuality(mesh);
  EXPECT_EQ(q.flippedEdges, 3u);
  EXPECT_EQ(faults(q), 3u);
  EXPECT_FALSE(q.closed);
}

TEST(MeshQuality, CountsAVertexThatTwoBodiesShare) {
  const TriangleMesh mesh =
      welded(shapes::append(shapes::cube(1.0), shapes::cube(1.0, {1.0, 1.0, 1.0})));
  const MeshQuality q = meshQuality(mesh);
  EXPECT_EQ(q.vertices, 15u);
  EXPECT_EQ(q.nonManifoldVertices, 1u);
  EXPECT_EQ(faults(q), 1u);
  EXPECT_TRUE(q.closed);
  EXPECT_EQ(q.components, 1u);
}

// Each direction of the shared edge is used twice: it has an inside.
TEST(MeshQuality, CountsAnEdgeThatTwoBodiesShare) {
  const TriangleMesh mesh =
      welded(shapes::append(shapes::cube(1.0), shapes::cube(1.0, {1.0, 1.0, 0.0})));
  const MeshQuality q = meshQuality(mesh);
  EXPECT_EQ(q.vertices, 14u);
  EXPECT_EQ(q.nonManifoldEdges, 1u);
  EXPECT_EQ(faults(q), 1u);
  EXPECT_TRUE(q.closed);
  EXPECT_FALSE(q.manifold());
}

TEST(MeshQuality, CountsTrianglesThatAreLinesOrTwins) {
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}},
                    {{0, 1, 2}, {0, 1, 3}, {3, 0, 1}, {1, 0, 3}, {1, 1, 3}}};
  const MeshQuality q = meshQuality(mesh);
  EXPECT_EQ(q.degenerateTriangles, 2u);  // 0 1 2, and the one of two equal corners
  EXPECT_EQ(q.duplicateTriangles, 2u);
  EXPECT_EQ(q.smallestAngle, 0.0);
  EXPECT_NEAR(q.sliverShare, 0.4, 1e-12);
  EXPECT_NEAR(q.meanSmallestAngle, 3 * 45.0 / 5, 1e-9);
}

// A triangle that is 1 wide and h high has its smallest angle at the foot: atan(h / 1) or so.
TEST(MeshQuality, MeasuresAnglesOfARightTriangle) {
  for (const double degrees : {0.5, 9.9, 10.1, 30.0, 44.0}) {
    const double h = std::tan(degrees * 3.14159265358979323846 / 180.0);
    const MeshQuality q = meshQuality({{{0, 0, 0}, {1, 0, 0}, {1, h, 0}}, {{0, 1, 2}}});
    EXPECT_NEAR(q.smallestAngle, degrees, 1e-9);
    EXPECT_EQ(q.sliverShare, degrees < 10.0 ? 1.0 : 0.0);
    EXPECT_EQ(q.boundaryEdges, 3u);
  }
}

TEST(MeshQuality, OfNothingIsNothing) {
  const MeshQuality q = meshQuality({});
  EXPECT_EQ(q.vertices + q.triangles + q.components + faults(q), 0u);
  EXPECT_FALSE(q.closed);
}

}  // namespace
}  // namespace sherd
