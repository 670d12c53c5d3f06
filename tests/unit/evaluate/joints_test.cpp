// Gaps, differences and contacts of fragments of which they are known.
#include <gtest/gtest.h>
#include <sherd/evaluate.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "shapes.h"

namespace sherd {
namespace {

constexpr std::size_t kFewDraws = 20;  // simulations, where p-values do not matter

FractureStatistics measured(const std::vector<TriangleMesh>& meshes, double unit = 0.0,
                            double tolerance = 0.05) {
  FragmentSet set;
  for (const TriangleMesh& mesh : meshes) {
    EvaluatedFragment& fragment = set.fragments.emplace_back();
    fragment.mesh = {static_cast<int>(set.fragments.size()), mesh};
  }
  return statistics(set, {.unit = unit, .simulations = kFewDraws, .tolerance = tolerance});
}

bool hasNote(const FractureStatistics& found, const std::string& words) {
  return std::any_of(found.notes.begin(), found.notes.end(), [&](const std::string& note) {
    return note.find(words) != std::string::npos;
  });
}

TEST(Joints, OfTwoBlocksHaveTheirGap) {
  for (const double gap : {0.0, 1e-3, 0.04}) {
    const FractureStatistics found =
        measured({shapes::cube(1.0), shapes::cube(1.0, {1.0 + gap, 0, 0})});
    const double diagonal = std::sqrt((2.0 + gap) * (2.0 + gap) + 2.0);
    ASSERT_TRUE(found.joints);
    for (const double quantile : found.joints->gap) EXPECT_NEAR(quantile, gap / diagonal, 1e-12);
    EXPECT_NEAR(found.joints->difference.value(), 0.0, 1e-7);
    EXPECT_EQ(found.coincident, gap == 0.0 ? 0.5 : 0.0);  // four corners of eight
    EXPECT_EQ(found.objects, 1u);
    EXPECT_EQ(found.joints->deepShare, 0.0);
  }
}

// Two pairs of cubes, whose faces have areas of 1 and 4: a fifth of the area has the first gap.
TEST(Joints, HaveQuantilesByArea) {
  const FractureStatistics found =
      measured({shapes::cube(1.0), shapes::cube(1.0, {1.01, 0, 0}), shapes::cube(2.0, {0, 50, 0}),
                shapes::cube(2.0, {2.1, 50, 0})},
               0.05, 0.01);
  ASSERT_TRUE(found.joints);
  EXPECT_EQ(found.objects, 2u);
  const double first = 0.01 / std::sqrt(2.01 * 2.01 + 2.0),
               second = 0.1 / std::sqrt(4.1 * 4.1 + 8.0);
  EXPECT_NEAR(found.joints->gap[0], first, 1e-12);
  for (const std::size_t i : {1u, 2u, 3u}) EXPECT_NEAR(found.joints->gap[i], second, 1e-12);
}

// A grid of triangles over a square of so many units, at heights.
template <class Height>
TriangleMesh surface(unsigned side, Height height) {
  TriangleMesh mesh;
  for (unsigned y = 0; y <= side; ++y) {
    for (unsigned x = 0; x <= side; ++x) mesh.vertices.emplace_back(x, y, height(x, y));
  }
  for (unsigned y = 0; y < side; ++y) {
    for (unsigned x = 0; x < side; ++x) {
      const unsigned i = y * (side + 1) + x;
      mesh.triangles.emplace_back(i, i + 1, i + side + 2);
      mesh.triangles.emplace_back(i, i + side + 2, i + side + 1);
    }
  }
  return mesh;
}

// One side is flat, the other has whole waves: their rms is half the height at 64 of 65 nodes.  A
// tilt and an offset of the other side change nothing.
TEST(Joints, HaveTheDifferenceOfADisplacedSide) {
  constexpr unsigned kSide = 64;
  constexpr double kHeight = 0.3, kPi = std::numbers::pi;
  for (const double tilt : {0.0, 0.002}) {
    TriangleMesh flat = surface(kSide, [](unsigned, unsigned) { return 0.0; });
    TriangleMesh waves = shapes::inverted(surface(kSide, [&](unsigned x, unsigned y) {
      return kHeight * std::sin(2.0 * kPi * 3.0 * x / kSide) *
                 std::sin(2.0 * kPi * 5.0 * y / kSide) +
             tilt * x + 40.0 * tilt;
    }));
    flat.neighbor.assign(flat.triangles.size(), 2);
    waves.neighbor.assign(waves.triangles.size(), 1);
    const Box box = bounds(waves);
    const double low = std::min(0.0, box.min.z), high = std::max(0.0, box.max.z);
    const double diagonal = std::sqrt(2.0 * kSide * kSide + (high - low) * (high - low));
    const FractureStatistics found = measured({flat, waves}, 1.0);
    ASSERT_TRUE(found.joints && found.joints->difference);
    const double nodes = (kSide + 1.0) * (kSide + 1.0);
    const double expected = kHeight * 0.5 * kSide / std::sqrt(nodes - 3.0);
    EXPECT_NEAR(*found.joints->difference * diagonal, expected, 1e-4 * expected);
  }
}

std::vector<TriangleMesh> row(const std::vector<double>& positions) {
  std::vector<TriangleMesh> cubes;
  for (const double x : positions) cubes.push_back(shapes::cube(1.0, {x, 0, 0}));
  return cubes;
}

TEST(Joints, CountObjectsThatDoNotTouch) {
  const FractureStatistics found = measured(row({0, 1, 6, 2, 7}), 0.0, 1e-3);
  EXPECT_EQ(found.objects, 2u);
  std::vector<std::size_t> objects;
  for (const FragmentShape& shape : found.fragments) objects.push_back(shape.object);
  EXPECT_EQ(objects, (std::vector<std::size_t>{1, 1, 2, 1, 2}));
  EXPECT_TRUE(hasNote(found, "no contact joins 2 sets"));
  EXPECT_FALSE(hasNote(measured(row({0, 1, 2})), "sets of fragments"));
}

// Gaps of two objects are shares of their own diagonals.
TEST(Joints, AreMeasuredByTheirObject) {
  const FractureStatistics found = measured(row({0, 1.01, 500, 501.01}), 0.01, 1e-4);
  ASSERT_TRUE(found.joints);
  for (const double quantile : found.joints->gap) {
    EXPECT_NEAR(quantile, 0.01 / std::sqrt(2.01 * 2.01 + 2.0), 1e-9);
  }
}

TEST(Joints, OfFragmentsInEachOtherAreDeep) {
  const FractureStatistics found = measured(row({0, 0.5}), 0.0, 0.01);
  ASSERT_TRUE(found.joints);
  EXPECT_GT(found.joints->deepShare, 0.05);
  EXPECT_TRUE(hasNote(found, "deep inside other fragments"));
}

// Half of the one side was worn off, by more than the tolerance: so it is of both sides' cracks.
TEST(Joints, HaveTheShareThatWasRemoved) {
  const auto pair = [](double depth) {
    std::vector<TriangleMesh> sides(2);
    sides[0] = surface(40, [](unsigned, unsigned) { return 0.0; });
    sides[1] =
        shapes::inverted(surface(40, [&](unsigned x, unsigned) { return x <= 20 ? 0.0 : depth; }));
    for (std::size_t i = 0; i < 2; ++i) {
      sides[i].neighbor.assign(sides[i].triangles.size(), static_cast<std::uint16_t>(2 - i));
    }
    return sides;
  };
  const std::optional<JointStatistics> worn = measured(pair(4.0), 1.0, 0.03).joints,
                                       whole = measured(pair(0.5), 1.0, 0.03).joints;
  ASSERT_TRUE(worn && whole);
  EXPECT_NEAR(worn->removed.value(), 0.5, 0.05);  // but for the step
  EXPECT_EQ(whole->removed.value(), 0.0);
  const FractureStatistics byDistance =
      measured({shapes::cube(1.0), shapes::cube(1.0, {1.01, 0, 0})});
  EXPECT_FALSE(byDistance.joints.value().removed);
}

TEST(Joints, CountCracksWhoseNeighborIsMissing) {
  TriangleMesh left = shapes::cube(1.0), right = shapes::cube(1.0, {1, 0, 0});
  for (TriangleMesh* mesh : {&left, &right}) {
    for (const glm::uvec3& t : mesh->triangles) {
      const auto at = [&](int axis, double value) {
        return mesh->vertices[t.x][axis] == value && mesh->vertices[t.y][axis] == value &&
               mesh->vertices[t.z][axis] == value;
      };
      const int other = mesh == &left ? 2 : 1;
      mesh->neighbor.push_back(static_cast<std::uint16_t>(at(0, 0.5) ? other : at(1, 0.5) ? 7 : 0));
    }
  }
  EXPECT_NEAR(measured({left, right}).unmatched, 0.5, 1e-12);
  EXPECT_EQ(measured({shapes::cube(1.0), shapes::cube(1.0, {1, 0, 0})}).unmatched, 0.0);
}

// A row of five has four contacts of ten pairs, all of consecutive ids, or none.
TEST(Joints, CompareContactsOfConsecutiveIds) {
  EXPECT_NEAR(measured(row({0, 1, 2, 3, 4})).consecutiveExcess.value(), 1.0 - 0.4, 1e-12);
  EXPECT_NEAR(measured(row({0, 3, 1, 4, 2})).consecutiveExcess.value(), -0.4, 1e-12);
  EXPECT_FALSE(measured(row({0, 1})).consecutiveExcess);
  EXPECT_FALSE(measured(row({0})).joints);
}

}  // namespace
}  // namespace sherd
