// Edges of triangles, against maps.
#include "remesh/face_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "base/random.h"
#include "shapes.h"

namespace sherd {
namespace {

TEST(FaceEdges, OfAClosedMeshAreUsedOnceInEachDirection) {
  for (const TriangleMesh& mesh : {shapes::cube(1.0), shapes::torus(1.0, 0.3, 12, 8)}) {
    const FaceEdges edges(mesh.triangles, mesh.vertices.size());
    EXPECT_EQ(2 * edges.count(), 3 * mesh.triangles.size());
    for (std::size_t e = 0; e < edges.count(); ++e) {
      ASSERT_EQ(edges.uses(e).size(), 2u);
      EXPECT_NE(edges.uses(e)[0].isForward, edges.uses(e)[1].isForward);
    }
  }
}

TEST(FaceEdges, OfRandomTrianglesAreThoseOfAMap) {
  constexpr std::uint32_t kVertices = 12;
  std::vector<glm::uvec3> triangles;
  for (std::uint64_t item = 0; triangles.size() < 200; item += 3) {
    glm::uvec3 t(0);
    for (int k = 0; k < 3; ++k) {
      t[k] = static_cast<std::uint32_t>(
          randomBelow(kVertices, 1, Stage::noise, item + static_cast<std::uint64_t>(k)));
    }
    if (t.x != t.y && t.y != t.z && t.z != t.x) triangles.push_back(t);
  }
  struct Use {
    std::uint32_t face;
    int corner;
    bool isForward;
  };
  std::map<std::array<std::uint32_t, 2>, std::vector<Use>> expected;
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[f][k], b = triangles[f][(k + 1) % 3];
      expected[{std::min(a, b), std::max(a, b)}].push_back({f, k, a < b});
    }
  }
  const FaceEdges edges(triangles, kVertices);
  ASSERT_EQ(edges.count(), expected.size());
  std::uint32_t e = 0;
  for (const auto& [ends, uses] : expected) {  // ascending by ends
    EXPECT_EQ(edges.ends(e), ends);
    EXPECT_EQ(edges.between(ends[0], ends[1]), e);
    EXPECT_EQ(edges.between(ends[1], ends[0]), e);
    ASSERT_EQ(edges.uses(e).size(), uses.size());
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const FaceEdges::Use& use = edges.uses(e)[i];
      EXPECT_EQ(use.face, uses[i].face);
      EXPECT_EQ(use.corner, uses[i].corner);
      EXPECT_EQ(use.isForward, uses[i].isForward);
      EXPECT_EQ(edges.of(use.face)[use.corner], e);
    }
    ++e;
  }
}

TEST(FaceEdges, ThereIsNoEdgeBetweenVerticesWithoutACommonFace) {
  const std::vector<glm::uvec3> triangles{{0, 1, 2}, {1, 3, 2}};
  const FaceEdges edges(triangles, 5);
  EXPECT_EQ(edges.count(), 5u);
  EXPECT_EQ(edges.between(0, 3), FaceEdges::kNone);
  EXPECT_EQ(edges.between(2, 4), FaceEdges::kNone);
  EXPECT_EQ(FaceEdges({}, 0).count(), 0u);
}

}  // namespace
}  // namespace sherd
