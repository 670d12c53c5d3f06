// How bodies fit whose gap, overlap and distance are known.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <vector>

#include "shapes.h"

namespace sherd {
namespace {

/// Five standard deviations of a share of n points.
double noise(double share, double n = 5000.0) { return 5.0 * std::sqrt(share * (1 - share) / n); }

/// A unit cube about x, whose faces at x + side / 2 face `other`.
FragmentMesh cubeBeside(int id, double x, double side, std::uint16_t other) {
  FragmentMesh fragment{id, shapes::cube(1.0, {x, 0.0, 0.0})};
  for (const glm::uvec3& t : fragment.mesh.triangles) {
    bool all = true;
    for (int k = 0; k < 3; ++k) all &= fragment.mesh.vertices[t[k]].x == x + side / 2;
    fragment.mesh.neighbor.push_back(all ? other : std::uint16_t{0});
  }
  return fragment;
}

TEST(Fit, MeasuresTheGapOfTwoBoxes) {
  for (const double gap : {0.25, 0.01}) {
    const std::vector<FragmentMesh> boxes{cubeBeside(1, 0.0, 1, 2),
                                          cubeBeside(2, 1.0 + gap, -1, 1)};
    const Fit found = fit(boxes, nullptr);
    EXPECT_NEAR(found.gap->mean, gap, 1e-12);
    EXPECT_NEAR(found.gap->p99, gap, 1e-12);
    EXPECT_NEAR(found.gap->max, gap, 1e-12);
    EXPECT_EQ(found.overlapShare, 0.0);
    EXPECT_EQ(found.overlapDepth, 0.0);
    for (const FragmentFit& one : found.fragments) {
      EXPECT_NEAR(one.fractureShare, 1.0 / 6, noise(1.0 / 6));
      EXPECT_EQ(one.originalShare, 1.0 - one.fractureShare);
      EXPECT_EQ(one.insideShare, 0.0);
      EXPECT_EQ(one.neighbors.size(), gap < 0.01 * found.diagonal ? 1u : 0u);
      EXPECT_FALSE(one.surfaceError);
    }
  }
}

// The boxes' sides lie in the same planes: they are on one another, not inside.  A point of the
// face in the other box is as deep as the overlap, but near the face's rim.
TEST(Fit, MeasuresTheOverlapOfTwoBoxes) {
  for (const double overlap : {0.25, 0.05}) {
    const std::vector<FragmentMesh> boxes{cubeBeside(1, 0.0, 1, 2),
                                          cubeBeside(2, 1.0 - overlap, -1, 1)};
    const Fit found = fit(boxes, nullptr);
    EXPECT_NEAR(*found.overlapShare, overlap, noise(overlap, 10000));
    EXPECT_NEAR(found.overlapDepth, overlap, 1e-6);
    EXPECT_EQ(found.gap->max, 0.0);
    for (const FragmentFit& one : found.fragments) {
      EXPECT_NEAR(*one.overlapShare, overlap, noise(overlap));
      EXPECT_NEAR(*one.insideShare, 1.0 / 6, noise(1.0 / 6));
      EXPECT_EQ(one.neighbors.size(), 1u);
    }
  }
}

TEST(Fit, BoxesThatTouchDoNotOverlap) {
  const std::vector<FragmentMesh> boxes{cubeBeside(3, 0.0, 1, 9), cubeBeside(9, 1.0, -1, 3)};
  const Fit found = fit(boxes, nullptr);
  EXPECT_LT(found.gap->max, 1e-12);
  EXPECT_EQ(found.overlapShare, 0.0);
  EXPECT_EQ(found.overlapDepth, 0.0);
  EXPECT_EQ(found.fragments[0].neighbors, std::vector<int>{9});
  EXPECT_EQ(found.fragments[1].neighbors, std::vector<int>{3});
}

TEST(Fit, LeavesOutWhatFacesAFragmentThatIsLost) {
  const std::vector<FragmentMesh> boxes{cubeBeside(1, 0.0, 1, 7), cubeBeside(2, 3.0, -1, 1)};
  const Fit found = fit(boxes, nullptr);
  EXPECT_EQ(found.fragments[0].fractureShare, 0.0);
  EXPECT_NEAR(found.fragments[0].originalShare, 5.0 / 6, noise(5.0 / 6));
  EXPECT_FALSE(found.fragments[0].gap);
  EXPECT_NEAR(found.gap->mean, 2.0, 1e-12);
}

// A facet of a polyhedron about the origin, h away from it, is e h away from the same facet of the
// polyhedron that is 1 + e times as large.  Facets of edges up to 0.083 lie at most
// 0.083^2 / 6 = 0.0012 inside the unit sphere.
TEST(Fit, MeasuresHowFarABallIsFromALargerOne) {
  const double e = 0.1;
  const std::vector<FragmentMesh> ball{{1, shapes::ball(1.0, 4)}};
  const TriangleMesh larger = shapes::ball(1.0 + e, 4);
  const FitOptions options{.tolerance = 0.5};
  const Fit found = fit(ball, &larger, options);
  for (const auto& distance : {found.surfaceError, found.missing}) {
    EXPECT_EQ(distance->samples, options.samples);
    EXPECT_GT(distance->mean, e * (1.0 - 0.0012));
    EXPECT_LT(distance->max, e + 1e-9);
    EXPECT_GE(distance->p99, distance->mean);
    EXPECT_LE(distance->p99, distance->max);
  }
  EXPECT_EQ(found.fragments[0].originalShare, 1.0);
  EXPECT_FALSE(found.gap);  // there is no other fragment
  EXPECT_EQ(found.overlapShare, 0.0);
  EXPECT_DOUBLE_EQ(*found.wholeVolume, volume(larger));
  const double lost = 1.0 - 1.0 / std::pow(1.0 + e, 3);
  EXPECT_NEAR(*found.voidShare, lost, noise(lost));
}

// Either half shows one of its six faces to the other; along the rims nothing is mistaken, as the
// way to the other half is along the surface there.
TEST(Fit, FindsFracturesWhereNeighborsAreNotKnown) {
  const std::vector<FragmentMesh> halves{{1, shapes::cube(1.0, {0, 0, 0})},
                                         {2, shapes::cube(1.0, {1, 0, 0})}};
  TriangleMesh brick = shapes::cube(1.0);
  for (glm::dvec3& v : brick.vertices) v.x = v.x < 0 ? -0.5 : 1.5;
  for (const TriangleMesh* whole : std::initializer_list<const TriangleMesh*>{nullptr, &brick}) {
    const Fit found = fit(halves, whole);
    EXPECT_DOUBLE_EQ(found.diagonal, std::sqrt(6.0));
    for (const FragmentFit& one : found.fragments) {
      EXPECT_NEAR(one.fractureShare, 1.0 / 6, noise(1.0 / 6));
      EXPECT_EQ(one.originalShare, 1.0 - one.fractureShare);
      EXPECT_EQ(one.neighbors.size(), 1u);
    }
    EXPECT_LT(found.gap->max, 1e-12);
    EXPECT_EQ(found.surfaceError.has_value(), whole != nullptr);
    if (!whole) continue;
    EXPECT_LT(found.surfaceError->max, 1e-12);
    EXPECT_LT(found.missing->max, 1e-12);
    EXPECT_EQ(found.voidShare, 0.0);
  }
}

// Halves that are g apart.  Of the faces between them what is nearer than g to the brick's own
// surface counts as that.
TEST(Fit, FindsTheGapWhereNeighborsAreNotKnown) {
  const double g = 0.02;
  const std::vector<FragmentMesh> halves{{1, shapes::cube(1.0, {0, 0, 0})},
                                         {2, shapes::cube(1.0, {1 + g, 0, 0})}};
  TriangleMesh brick = shapes::cube(1.0);
  for (glm::dvec3& v : brick.vertices) v.x = v.x < 0 ? -0.5 : 1.5 + g;
  const Fit alone = fit(halves, nullptr), within = fit(halves, &brick);
  EXPECT_NEAR(alone.fragments[0].fractureShare, 1.0 / 6, noise(1.0 / 6));
  const double inner = std::pow(1.0 - 2.0 * g, 2) / 6.0;
  EXPECT_NEAR(within.fragments[0].fractureShare, inner, noise(inner));
  for (const Fit& found : {alone, within}) {
    EXPECT_NEAR(found.gap->mean, g, 1e-12);
    EXPECT_NEAR(found.gap->max, g, 1e-12);
  }
  EXPECT_LE(within.surfaceError->max, g);
  EXPECT_NEAR(*within.voidShare, g / (2.0 + g), noise(g / (2.0 + g)));
}

TEST(Fit, OpenFragmentsHoldNothing) {
  FragmentMesh open{1, shapes::cube(1.0)};
  open.mesh.triangles.pop_back();
  const std::vector<FragmentMesh> fragments{open, {2, shapes::cube(0.5)}};
  const TriangleMesh whole = shapes::cube(2.0);
  const Fit found = fit(fragments, &whole);
  EXPECT_FALSE(found.fragments[0].overlapShare);
  EXPECT_EQ(found.fragments[1].overlapShare, 0.0);
  EXPECT_EQ(found.fragments[1].insideShare, 0.0);
  EXPECT_FALSE(found.voidShare);
}

TEST(Fit, DoesNotDependOnThreadsOrPlace) {
  const std::vector<FragmentMesh> pair{{1, shapes::torus(1.0, 0.4)}, {2, shapes::ball(0.8)}};
  const Fit once = fit(pair, nullptr, {.samples = 2000, .seed = 5});
  Fit again;
  tbb::task_arena alone(1);
  alone.execute([&] { again = fit(pair, nullptr, {.samples = 2000, .seed = 5}); });
  EXPECT_EQ(once.overlapShare, again.overlapShare);
  EXPECT_EQ(once.overlapDepth, again.overlapDepth);
  EXPECT_GT(once.overlapDepth, 0.1);
  EXPECT_EQ(once.gap->mean, again.gap->mean);
  EXPECT_NE(once.overlapShare, fit(pair, nullptr, {.samples = 2000, .seed = 6}).overlapShare);

  std::vector<FragmentMesh> there = pair;
  for (FragmentMesh& f : there) f.mesh = shapes::transformed(f.mesh, 8.0, {64, -32, 128});
  const Fit moved = fit(there, nullptr, {.samples = 2000, .seed = 5});
  EXPECT_NEAR(moved.overlapDepth, 8.0 * once.overlapDepth, 1e-9);
  EXPECT_NEAR(*moved.overlapShare, *once.overlapShare, 1e-3);
}

TEST(Fit, RefusesOptionsThatCannotBe) {
  const std::vector<FragmentMesh> cube{{1, shapes::cube(1.0)}};
  EXPECT_THROW((void)fit(cube, nullptr, {.samples = 0}), Error);
  EXPECT_THROW((void)fit(cube, nullptr, {.tolerance = 0.0}), Error);
  EXPECT_THROW((void)fit(cube, nullptr, {.tolerance = NAN}), Error);
  const std::vector<FragmentMesh> none{{1, {}}};
  EXPECT_THROW((void)fit(none, nullptr), Error);
  EXPECT_TRUE(fit({}, nullptr).fragments.empty());
}

}  // namespace
}  // namespace sherd
