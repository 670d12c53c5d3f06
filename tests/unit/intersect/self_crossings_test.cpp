// Crossing triangles, against clipping in rational numbers.
#include "intersect/self_crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/random.h"

namespace sherd {
namespace {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;
using Rational = boost::multiprecision::cpp_rational;
using CornerPoint = std::array<Rational, 3>;
using Polygon = std::vector<CornerPoint>;

CornerPoint minusExactly(const CornerPoint& a, const CornerPoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Rational dot(const CornerPoint& a, const CornerPoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
CornerPoint cross(const CornerPoint& a, const CornerPoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// The part of a convex polygon, possibly flat, where dot(normal, p - on) >= 0.
Polygon clipped(const Polygon& polygon, const CornerPoint& on, const CornerPoint& normal) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const CornerPoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Rational atP = dot(normal, minusExactly(p, on)), atQ = dot(normal, minusExactly(q, on));
    if (atP >= 0) kept.push_back(p);
    if ((atP > 0 && atQ < 0) || (atP < 0 && atQ > 0)) {
      const Rational t = atP / (atP - atQ);
      const CornerPoint along = minusExactly(q, p);
      kept.push_back({p[0] + t * along[0], p[1] + t * along[1], p[2] + t * along[2]});
    }
  }
  return kept;
}

// The corners of what two triangles have in common.
Polygon common(const Polygon& s, const Polygon& t) {
  const CornerPoint normal = cross(minusExactly(t[1], t[0]), minusExactly(t[2], t[0]));
  Polygon rest = clipped(s, t[0], normal);
  rest = clipped(rest, t[0], {-normal[0], -normal[1], -normal[2]});
  for (std::size_t k = 0; k < 3; ++k) {
    rest = clipped(rest, t[k], cross(normal, minusExactly(t[(k + 1) % 3], t[k])));
  }
  return rest;
}

bool isOnSegment(const CornerPoint& p, const CornerPoint& a, const CornerPoint& b) {
  const CornerPoint along = minusExactly(b, a), apart = minusExactly(p, a);
  return cross(along, apart) == CornerPoint{0, 0, 0} && dot(apart, along) >= 0 &&
         dot(apart, along) <= dot(along, along);
}

struct Mesh {
  std::vector<glm::dvec3> vertices;
  std::vector<glm::uvec3> triangles;
};

// Common points beside the common vertices, or the segment between two of them, exist if one of
// the corners of the common part, which is convex, is such a point.
bool doCross(const Mesh& mesh, const glm::uvec3& s, const glm::uvec3& t) {
  const auto at = [&](std::uint32_t v) {
    const glm::dvec3& p = mesh.vertices[v];
    return CornerPoint{Rational(p.x), Rational(p.y), Rational(p.z)};
  };
  Polygon shared;
  for (int k = 0; k < 3; ++k) {
    if (s[k] == t.x || s[k] == t.y || s[k] == t.z) shared.push_back(at(s[k]));
  }
  if (shared.size() == 3) return true;
  const Polygon points = common({at(s.x), at(s.y), at(s.z)}, {at(t.x), at(t.y), at(t.z)});
  return std::any_of(points.begin(), points.end(), [&](const CornerPoint& p) {
    if (shared.size() == 2) return !isOnSegment(p, shared[0], shared[1]);
    return shared.empty() || p != shared[0];
  });
}

Pairs expectedCrossings(const Mesh& mesh) {
  Pairs pairs;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::uint32_t j = i + 1; j < mesh.triangles.size(); ++j) {
      if (doCross(mesh, mesh.triangles[i], mesh.triangles[j])) pairs.push_back({i, j});
    }
  }
  return pairs;
}

Pairs crossingsOf(const Mesh& mesh) { return selfCrossings(mesh.vertices, mesh.triangles); }

// Triangles with area between random points of side^3, which share vertices if `isConnected`.
Mesh randomMesh(std::uint64_t seed, std::uint64_t side, std::size_t triangles, bool isConnected) {
  Mesh mesh;
  std::uint64_t item = 0;
  const auto random = [&](std::uint64_t below) {
    return randomBelow(below, seed, Stage::noise, item++);
  };
  if (isConnected) {
    for (std::uint64_t i = 0; i < side * side * side; ++i) {
      mesh.vertices.emplace_back(i / (side * side), i / side % side, i % side);
    }
  }
  while (mesh.triangles.size() < triangles) {
    glm::uvec3 t(0);
    std::array<glm::dvec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = glm::dvec3(random(side), random(side), random(side));
      t[static_cast<int>(k)] = static_cast<std::uint32_t>(
          isConnected
              ? (p[k].x * static_cast<double>(side) + p[k].y) * static_cast<double>(side) + p[k].z
              : static_cast<double>(mesh.vertices.size() + k));
    }
    if (glm::cross(p[1] - p[0], p[2] - p[0]) == glm::dvec3(0.0)) continue;
    if (!isConnected) mesh.vertices.insert(mesh.vertices.end(), p.begin(), p.end());
    mesh.triangles.push_back(t);
  }
  return mesh;
}

TEST(SelfCrossings, OfRandomTrianglesAreThoseOfRationalClipping) {
  for (const bool isConnected : {false, true}) {
    for (const std::uint64_t side : {2u, 3u, 5u}) {
      for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const Mesh mesh = randomMesh(seed, side, 40, isConnected);
        const Pairs expected = expectedCrossings(mesh);
        EXPECT_FALSE(expected.empty());
        EXPECT_LT(expected.size(), 780u);  // all pairs
        EXPECT_EQ(crossingsOf(mesh), expected)
            << "connected " << isConnected << ", side " << side << ", seed " << seed;
      }
    }
  }
}

// Few triangles that are tested are looked up otherwise than many.
TEST(SelfCrossings, OfTestedTrianglesAreThosePairsOfAll) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Mesh mesh = randomMesh(seed, 5, 60, seed % 2 == 0);
    const Pairs all = expectedCrossings(mesh);
    for (const std::uint32_t step : {1u, 2u, 7u, 30u, 59u}) {
      std::vector<std::uint8_t> isTested(mesh.triangles.size());
      std::vector<std::uint32_t> source;  // of pairs beside each other
      for (std::uint32_t t = 0; t < isTested.size(); ++t) {
        isTested[t] = t % step == 1 % step ? 1 : 0;
        source.push_back(t / 2);
      }
      Pairs expected, ofOthers;
      for (const auto& [a, b] : all) {
        if (isTested[a] + isTested[b] == 0) continue;
        expected.push_back({a, b});
        if (source[a] != source[b]) ofOthers.push_back({a, b});
      }
      const auto found = [&](const CrossingPairs& tested) {
        return selfCrossings(mesh.vertices, mesh.triangles, nullptr, tested);
      };
      EXPECT_FALSE(expected.empty());
      EXPECT_EQ(found({.of = isTested}), expected) << "seed " << seed << ", step " << step;
      EXPECT_EQ(found({.of = isTested, .source = source}), ofOthers);
    }
  }
}

// A triangle in the plane z = 0 and another one.
Mesh withTriangle(const std::array<glm::dvec3, 3>& other) {
  return {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, other[0], other[1], other[2]}, {{0, 1, 2}, {3, 4, 5}}};
}

const Pairs kFirstTwo{{0, 1}};

TEST(SelfCrossings, ATriangleThroughAnotherCrossesIt) {
  EXPECT_EQ(crossingsOf(withTriangle({{{1, 1, -1}, {1, 1, 1}, {9, 9, 0}}})), kFirstTwo);
  EXPECT_TRUE(crossingsOf(withTriangle({{{3, 3, -1}, {3, 3, 1}, {9, 9, 0}}})).empty());
}

TEST(SelfCrossings, TouchingTrianglesCross) {
  // With a corner: inside, on an edge, on a corner that is not shared.
  for (const glm::dvec3& tip : {glm::dvec3(1, 1, 0), glm::dvec3(2, 2, 0), glm::dvec3(0, 4, 0)}) {
    EXPECT_EQ(crossingsOf(withTriangle({{tip, {1, 0, 5}, {0, 1, 5}}})), kFirstTwo);
  }
  // Two edges in one point, and along a part.
  EXPECT_EQ(crossingsOf(withTriangle({{{2, 2, -1}, {2, 2, 1}, {9, 9, 0}}})), kFirstTwo);
  EXPECT_EQ(crossingsOf(withTriangle({{{1, 0, 0}, {9, 0, 0}, {1, -1, 3}}})), kFirstTwo);
}

TEST(SelfCrossings, TheLeastDoubleBesideATriangleIsApart) {
  const double above = 0x1p-1000;
  EXPECT_TRUE(crossingsOf(withTriangle({{{1, 1, above}, {2, 1, 5}, {1, 2, 5}}})).empty());
  EXPECT_EQ(crossingsOf(withTriangle({{{1, 1, -above}, {2, 1, 5}, {1, 2, 5}}})), kFirstTwo);
}

TEST(SelfCrossings, TrianglesInOnePlaneCrossIfTheyMeet) {
  EXPECT_EQ(crossingsOf(withTriangle({{{1, 1, 0}, {9, 9, 0}, {9, 8, 0}}})), kFirstTwo);
  EXPECT_EQ(crossingsOf(withTriangle({{{1, 1, 0}, {1.5, 1, 0}, {1, 1.5, 0}}})), kFirstTwo);
  EXPECT_EQ(crossingsOf(withTriangle({{{-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}}})), kFirstTwo);
  EXPECT_TRUE(crossingsOf(withTriangle({{{3, 2, 0}, {9, 9, 0}, {9, 8, 0}}})).empty());
}

TEST(SelfCrossings, EdgesOnOneLineAreApartUnlessTheyMeet) {
  EXPECT_TRUE(crossingsOf(withTriangle({{{5, 0, 0}, {9, 0, 0}, {5, -3, 0}}})).empty());
  EXPECT_TRUE(crossingsOf(withTriangle({{{5, 0, 0}, {9, 0, 0}, {5, 0, 3}}})).empty());
  EXPECT_EQ(crossingsOf(withTriangle({{{4, 0, 0}, {9, 0, 0}, {5, -3, 0}}})), kFirstTwo);
}

TEST(SelfCrossings, TrianglesThatShareAVertexCrossElsewhereOnly) {
  Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {1, 1, -1}}, {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_EQ(crossingsOf(mesh), kFirstTwo);
  mesh.vertices[4] = {1, 2, 1};
  EXPECT_TRUE(crossingsOf(mesh).empty());
  mesh.vertices[3] = {2, 0, 0};  // along an edge
  EXPECT_EQ(crossingsOf(mesh), kFirstTwo);
}

TEST(SelfCrossings, TrianglesThatShareAnEdgeCrossIfTheyAreFolded) {
  Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_EQ(crossingsOf(mesh), kFirstTwo);
  mesh.vertices[3] = {1, 1, 0x1p-1000};
  EXPECT_TRUE(crossingsOf(mesh).empty());
  mesh.vertices[3] = {1, -1, 0};
  EXPECT_TRUE(crossingsOf(mesh).empty());
  mesh.triangles[1] = {2, 1, 0};  // the same triangle reversed
  EXPECT_EQ(crossingsOf(mesh), kFirstTwo);
}

// A sliver with corners as near to each other as numbers are: the difference of its corner to one
// far away is rounded to that of its neighbor's.
TEST(SelfCrossings, ASliverBesideATriangleIsNotFoldedOntoIt) {
  const double y = -0.2, next = std::nextafter(std::nextafter(y, 0.0), 0.0);
  const std::vector<glm::dvec3> vertices{
      {0.5, -0.5, -0.5}, {0.5, 0.5, -0.5}, {0.5, y, -0.2}, {0.5, next, -0.2}};
  EXPECT_TRUE(selfCrossings(vertices, std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 3}}).empty());
  EXPECT_EQ(selfCrossings(vertices, std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 0}}).size(), 1u);
}

TEST(SelfCrossings, ATriangleWithoutAreaIsASegment) {
  const std::vector<glm::dvec3> vertices{{0, 0, 0}, {4, 0, 0},  {0, 4, 0},    // a triangle
                                         {1, 1, 1}, {1, 1, -1}, {1, 1, 0.5},  // through it
                                         {1, 1, 3}, {2, 2, 3},  {3, 3, 3}};   // beside it
  EXPECT_EQ(selfCrossings(vertices, std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}),
            (Pairs{{0, 1}}));
}

TEST(SelfCrossings, OfNoTrianglesAreNone) { EXPECT_TRUE(crossingsOf({}).empty()); }

}  // namespace
}  // namespace sherd
