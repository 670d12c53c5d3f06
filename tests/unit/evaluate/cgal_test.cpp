// CGAL and Sherd say the same of a mesh.
#include <gtest/gtest.h>
#include <sherd/evaluate.h>

#include <cstdlib>

#include "cli/evaluate/cgal_checks.h"
#include "shapes.h"

namespace sherd {
namespace {

class Cgal : public testing::Test {
 protected:
  void SetUp() override {
    const char* required = std::getenv("SHERD_REQUIRE_CGAL");
    if (!hasCgalChecks() && !(required && *required == '1')) {
      GTEST_SKIP() << "this build has no checks by CGAL (SHERD_GPL)";
    }
  }
};

// From the same points, by another hull, another tree and another test for inside.  Single
// precision may put a point of ours on the other side of the surface: one in a thousand at most.
TEST_F(Cgal, AgreesOnConvexity) {
  for (const TriangleMesh& mesh :
       {shapes::cup(1.0, 0.2, 2.0, 0.3), shapes::torus(1.0, 0.3, 32, 16), shapes::cube(3.0)}) {
    const Convexity ours = convexity(mesh, 2000, 3);
    const CgalVerdict verdict = checkWithCgal(mesh, 2000, 3);
    EXPECT_TRUE(verdict.polygonMesh && verdict.valid && verdict.closed && verdict.boundsVolume);
    EXPECT_EQ(verdict.selfIntersections, 0u);
    ASSERT_TRUE(verdict.convexity);
    EXPECT_NEAR(static_cast<double>(verdict.convexity->samples), static_cast<double>(ours.samples),
                2.0);
    EXPECT_NEAR(verdict.convexity->value, ours.value, 1e-3);
  }
}

TEST_F(Cgal, SeesWhatIsWrong) {
  TriangleMesh open = shapes::cube(1.0);
  open.triangles.pop_back();
  EXPECT_FALSE(checkWithCgal(open, 100, 0).closed);
  EXPECT_TRUE(checkWithCgal(open, 100, 0).polygonMesh);

  TriangleMesh fin = shapes::cube(1.0);
  fin.vertices.emplace_back(5, 5, 5);
  fin.triangles.emplace_back(fin.triangles[0].x, fin.triangles[0].y, 8u);
  EXPECT_GT(meshQuality(fin).nonManifoldEdges, 0u);
  EXPECT_FALSE(checkWithCgal(fin, 100, 0).polygonMesh);

  const CgalVerdict crossing =
      checkWithCgal(shapes::append(shapes::cube(1.0), shapes::cube(1.0, {0.3, 0.4, 0.5})), 100, 0);
  EXPECT_TRUE(crossing.closed);
  EXPECT_GT(crossing.selfIntersections, 0u);
  EXPECT_FALSE(crossing.boundsVolume);
}

// A wall about a cavity bounds a volume where the cavity is turned inwards, and only there.
TEST_F(Cgal, KnowsACavity) {
  EXPECT_TRUE(checkWithCgal(shapes::hollowBall(1.0, 0.5, 2), 100, 0).boundsVolume);
  EXPECT_FALSE(checkWithCgal(shapes::append(shapes::ball(1.0, 2), shapes::ball(0.5, 2)), 100, 0)
                   .boundsVolume);
}

}  // namespace
}  // namespace sherd
