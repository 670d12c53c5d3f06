// Triangles that fill loops of edges.
#include "remesh/parts/fill_loops.h"

#include <gtest/gtest.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "intersect/self_crossings.h"

namespace sherd {
namespace {

using Loop = std::vector<std::uint32_t>;

// Points of loops, which are added one after the other.
struct Rims {
  std::vector<glm::dvec3> vertices{};
  std::vector<Loop> loops{};

  void add(const std::vector<glm::dvec3>& points, bool isReversed = false) {
    Loop loop(points.size());
    std::iota(loop.begin(), loop.end(), static_cast<std::uint32_t>(vertices.size()));
    if (isReversed) std::reverse(loop.begin(), loop.end());
    vertices.insert(vertices.end(), points.begin(), points.end());
    loops.push_back(std::move(loop));
  }

  [[nodiscard]] TriangleMesh filled(const KnownEdges& edges = {}) const {
    const FilledLoops found = filledLoops(vertices, loops, edges, nullptr);
    TriangleMesh mesh{vertices, found.triangles};
    mesh.vertices.insert(mesh.vertices.end(), found.centers.begin(), found.centers.end());
    return mesh;
  }
};

// Uses of each edge from its lower vertex minus those from its higher one, without zeros.
using Balance = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

void addUse(Balance& balance, std::uint32_t from, std::uint32_t to) {
  const std::pair<std::uint32_t, std::uint32_t> edge = std::minmax(from, to);
  balance[edge] += from < to ? 1 : -1;
  if (balance[edge] == 0) balance.erase(edge);
}

void expectFills(const Rims& rims, const TriangleMesh& mesh) {
  Balance expected, found;
  for (const Loop& loop : rims.loops) {
    for (std::size_t i = 0; i < loop.size(); ++i)
      addUse(expected, loop[i], loop[(i + 1) % loop.size()]);
  }
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) addUse(found, t[k], t[(k + 1) % 3]);
  }
  EXPECT_EQ(found, expected);
}

std::vector<glm::dvec3> circle(int count, double radius, double wave = 0.0, double z = 0.0) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i) {
    const double a = 2.0 * std::numbers::pi * i / count;
    points.emplace_back(radius * std::cos(a), radius * std::sin(a), z + wave * std::sin(3.0 * a));
  }
  return points;
}

// The area of a regular polygon.
double areaOf(int count, double radius) {
  return 0.5 * count * radius * radius * std::sin(2.0 * std::numbers::pi / count);
}

TEST(FillLoops, AConcavePolygonHasItsArea) {
  Rims rims;  // an L, with vertices in the middle of edges
  rims.add(
      {{0, 0, 1}, {1, 0, 1}, {3, 0, 1}, {3, 1, 1}, {1, 1, 1}, {1, 2, 1}, {1, 3, 1}, {0, 3, 1}});
  for (const bool isReversed : {false, true}) {
    if (isReversed) std::reverse(rims.loops[0].begin(), rims.loops[0].end());
    const TriangleMesh mesh = rims.filled();
    expectFills(rims, mesh);
    EXPECT_EQ(mesh.triangles.size(), 6u);
    EXPECT_NEAR(area(mesh), 5.0, 1e-12);
    EXPECT_TRUE(selfCrossings(mesh.vertices, mesh.triangles).empty());
  }
}

TEST(FillLoops, ALoopWithinAnotherThatRunsTheOtherWayLeavesARing) {
  Rims rims;
  rims.add(circle(40, 1.0));
  rims.add(circle(24, 0.5), true);
  const TriangleMesh mesh = rims.filled();
  expectFills(rims, mesh);
  EXPECT_EQ(mesh.triangles.size(), 64u);
  EXPECT_NEAR(area(mesh), areaOf(40, 1.0) - areaOf(24, 0.5), 1e-12);
}

TEST(FillLoops, ALoopWithinAnotherThatRunsTheSameWayMakesTwoLayers) {
  Rims rims;
  rims.add(circle(40, 1.0));
  rims.add(circle(24, 0.5));
  const TriangleMesh mesh = rims.filled();
  expectFills(rims, mesh);
  EXPECT_NEAR(area(mesh), areaOf(40, 1.0) + areaOf(24, 0.5), 1e-12);
}

TEST(FillLoops, LoopsOfOnePlaneThatCrossAreFilledAlone) {
  Rims rims;
  rims.add(circle(12, 1.0));
  std::vector<glm::dvec3> other = circle(12, 1.0);
  for (glm::dvec3& p : other) p += glm::dvec3(1.0, 0.1, 0.0);
  rims.add(other);
  const TriangleMesh mesh = rims.filled();
  expectFills(rims, mesh);
  EXPECT_NEAR(area(mesh), 2.0 * areaOf(12, 1.0), 1e-12);
}

TEST(FillLoops, BentLoopsOfAnySizeAreFilled) {
  for (const int count : {4, 9, 100, 300}) {
    Rims rims;
    rims.add(circle(count, 1.0, 0.6));
    const TriangleMesh mesh = rims.filled();
    expectFills(rims, mesh);
    EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(count - 2));
    EXPECT_TRUE(selfCrossings(mesh.vertices, mesh.triangles).empty()) << count;
    EXPECT_GE(area(mesh), areaOf(count, 1.0) - 1e-12);  // seen from above it is the polygon
  }
}

// Two squares at a right angle, as an open box has whose top and one side are missing.
TEST(FillLoops, ABentLoopHasTheLeastArea) {
  Rims rims;
  rims.add({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 1, 1}, {0, 1, 1}, {0, 1, 0}});
  const TriangleMesh mesh = rims.filled();
  expectFills(rims, mesh);
  EXPECT_NEAR(area(mesh), 1.0 + 2.0 * std::sqrt(2.0), 1e-12);  // by the chord, and two ends
}

TEST(FillLoops, AKnownEdgeIsNotUsedAgain) {
  Rims rims;
  rims.add({{0, 0, 0}, {1, 0, 0.5}, {1, 1, 0}, {0, 1, 0.5}});
  for (const auto& known : {std::pair(0u, 2u), std::pair(1u, 3u)}) {
    for (const glm::uvec3& t : rims.filled({known}).triangles) {
      for (int k = 0; k < 3; ++k) {
        const std::pair<std::uint32_t, std::uint32_t> edge = std::minmax(t[k], t[(k + 1) % 3]);
        EXPECT_NE(edge, (std::pair<std::uint32_t, std::uint32_t>(known)));
      }
    }
  }
}

TEST(FillLoops, ALineAndALoopOfManyBendsAreFilled) {
  Rims rims;
  rims.add({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {2, 0, 0}});  // encloses nothing
  std::vector<glm::dvec3> coil;                            // its shadow crosses itself
  for (int i = 0; i < 400; ++i) {
    const double a = 2.0 * std::numbers::pi * i / 400;
    coil.emplace_back(std::sin(2.0 * a), std::sin(3.0 * a), std::cos(7.0 * a));
  }
  rims.add(coil);
  const TriangleMesh mesh = rims.filled();
  expectFills(rims, mesh);
  EXPECT_EQ(mesh.vertices.size(), rims.vertices.size() + 1);
}

}  // namespace
}  // namespace sherd
