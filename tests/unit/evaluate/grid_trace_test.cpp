// Grids in the vertices of meshes that were made on one, and in those of others.
#include "evaluate/cracks/grid_trace.h"

#include <gtest/gtest.h>
#include <sherd/evaluate.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

namespace sherd {
namespace {

constexpr unsigned kGridSide = 26;  // vertices along a crack
constexpr double kPitch = 0.37;

// Cracks, each a fragment of its own, with vertices at corners of a grid, moved by up to a share of
// the pitch along each axis.
std::vector<TriangleMesh> cracksOnAGrid(std::size_t count, double moved) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> shift(-0.5 * moved, 0.5 * moved);
  std::vector<TriangleMesh> cracks(count);
  for (std::size_t k = 0; k < count; ++k) {
    TriangleMesh& mesh = cracks[k];
    for (unsigned y = 0; y < kGridSide; ++y) {
      for (unsigned x = 0; x < kGridSide; ++x) {
        const glm::dvec3 corner(x, y,
                                static_cast<double>(random() % 4) + 100.0 * static_cast<double>(k));
        const glm::dvec3 apart(shift(random), shift(random), shift(random));
        mesh.vertices.push_back(kPitch * (corner + apart));
      }
    }
    for (unsigned y = 0; y + 1 < kGridSide; ++y) {
      for (unsigned x = 0; x + 1 < kGridSide; ++x) {
        const unsigned i = y * kGridSide + x;
        mesh.triangles.emplace_back(i, i + 1, i + kGridSide + 1);
        mesh.triangles.emplace_back(i, i + kGridSide + 1, i + kGridSide);
      }
    }
    mesh.neighbor.assign(mesh.triangles.size(), static_cast<std::uint16_t>(k == 0 ? 2 : 1));
  }
  return cracks;
}

std::optional<GridTrace> traceOf(const std::vector<TriangleMesh>& meshes, double unit) {
  FragmentSet set;
  for (const TriangleMesh& mesh : meshes) {
    set.fragments.emplace_back().mesh = {static_cast<int>(set.fragments.size()), mesh};
  }
  return statistics(set, {.unit = unit, .simulations = 20}).grid;
}

TEST(GridTrace, PointsOnPlanesAPitchApartHaveTheirNumberForPower) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> anywhere(-50.0, 50.0);
  GridPoints points;
  for (int i = 0; i < 500; ++i) {
    points.add({static_cast<double>(i % 37) - 18.0, anywhere(random), 0.5 * (i % 2)});
  }
  const std::vector<glm::dvec3> axes{{1, 0, 0}, {0, 0, 1}, {0, 0, 2}};
  const std::vector<double> power = powersAlong(points, axes);
  EXPECT_NEAR(power[0], 500.0, 0.1);
  EXPECT_NEAR(power[1], 0.0, 0.1);  // halves of the points are opposite
  EXPECT_NEAR(power[2], 500.0, 0.1);
}

TEST(GridTrace, PointsAtRandomHaveAPowerOfOneInTheMean) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> anywhere(-50.0, 50.0);
  std::normal_distribution<double> normal;
  GridPoints points;
  for (int i = 0; i < 700; ++i) points.add({anywhere(random), anywhere(random), anywhere(random)});
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 4000; ++i) {
    directions.push_back(
        glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))));
  }
  double mean = 0.0;
  for (const double power : powersAlong(points, directions)) mean += power / 4000.0;
  EXPECT_NEAR(mean, 1.0, 0.1);  // of an exponential: 4000 have a standard error of 0.016
}

TEST(GridTrace, IsFoundInVerticesOnTheGrid) {
  for (const double unit : {kPitch, 0.0}) {  // known, and not
    const auto trace = traceOf(cracksOnAGrid(5, 0.0), unit);
    ASSERT_TRUE(trace);
    EXPECT_EQ(trace->fragments, 5u);
    EXPECT_EQ(trace->isKnown, unit > 0.0);
    EXPECT_NEAR(trace->pitch, kPitch, 2e-3 * kPitch);
    EXPECT_GT(trace->power, 100.0);
    EXPECT_EQ(trace->found, 1.0);
  }
}

// Points that are uniform over cells of the grid have no power at its frequency.
TEST(GridTrace, IsNotFoundInVerticesAnywhere) {
  const auto trace = traceOf(cracksOnAGrid(24, 1.0), kPitch);
  ASSERT_TRUE(trace);
  // The logarithm of an exponential varies by 1.28, so that of 24 * 3 by 0.15.
  EXPECT_NEAR(std::log(trace->power), 0.0, 0.5);
  EXPECT_EQ(trace->found, 0.0);
}

// Moved by a uniform share a of the pitch, points keep (sin(pi a) / (pi a))^2 of their power.
TEST(GridTrace, LosesThePowerThatNoiseTakes) {
  const double exact = traceOf(cracksOnAGrid(8, 0.0), kPitch)->power;
  const double noisy = traceOf(cracksOnAGrid(8, 0.5), kPitch)->power;
  const double kept = std::pow(std::sin(0.5 * std::numbers::pi) / (0.5 * std::numbers::pi), 2.0);
  EXPECT_GT(noisy, 0.5 * kept * exact);
  EXPECT_LT(noisy, 2.0 * kept * exact);
  EXPECT_GT(noisy, 50.0);
}

// Phases of points that are 1e4 pitches apart are not known.
TEST(GridTrace, IsNotMeasuredOfAPitchFarBelowTheMesh) {
  for (const double pitch : {1e-6, 1e-30}) {
    EXPECT_FALSE(traceOf(cracksOnAGrid(8, 0.0), pitch * kPitch)) << pitch;
  }
}

// Along other axes than those of the grid there is none.
TEST(GridTrace, IsThatOfTheAxes) {
  std::vector<TriangleMesh> cracks = cracksOnAGrid(12, 0.0);
  const double c = std::cos(0.5), s = std::sin(0.5);
  const glm::dmat3 aboutZ(glm::dvec3(c, s, 0), glm::dvec3(-s, c, 0), glm::dvec3(0, 0, 1)),
      aboutX(glm::dvec3(1, 0, 0), glm::dvec3(0, c, s), glm::dvec3(0, -s, c));
  for (TriangleMesh& mesh : cracks) {
    for (glm::dvec3& p : mesh.vertices) p = aboutX * aboutZ * p;
  }
  const auto trace = traceOf(cracks, kPitch);
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->found, 0.0);
  EXPECT_LT(trace->power, 10.0);
}

TEST(GridTrace, NeedsVerticesWithinCracks) {
  std::vector<TriangleMesh> cracks = cracksOnAGrid(2, 0.0);
  for (TriangleMesh& mesh : cracks) std::fill(mesh.neighbor.begin(), mesh.neighbor.end(), 0);
  EXPECT_FALSE(traceOf(cracks, kPitch));
}

}  // namespace
}  // namespace sherd
