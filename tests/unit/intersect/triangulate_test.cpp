// The constrained triangulation of one triangle.
#include "intersect/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "base/random.h"

namespace sherd {
namespace {

using Segments = std::vector<std::array<std::uint32_t, 2>>;

// A triangle in the plane z = 0 with points of two coordinates, all exact.
class Fixture {
 public:
  Fixture() {
    for (std::size_t k = 0; k < 3; ++k) {
      points.push_back({ExactPoint(kCorners[k]), kCornerEdges[k]});
    }
  }
  std::uint32_t add(double x, double y, std::uint8_t edges = 0) {
    points.push_back({ExactPoint({x, y, 0.0}), edges});
    return static_cast<std::uint32_t>(points.size() - 1);
  }
  [[nodiscard]] Triangulation run() const { return triangulate(points, segments); }

  static constexpr std::array<glm::dvec3, 3> kCorners{
      {{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {0.0, 4.0, 0.0}}};
  std::vector<TrianglePoint> points;
  Segments segments;
};

double areaOf(const std::vector<TrianglePoint>& points, const glm::uvec3& t) {
  const glm::dvec3 a = points[t.x].point.rounded;
  return 0.5 *
         glm::length(glm::cross(points[t.y].point.rounded - a, points[t.z].point.rounded - a));
}

// Checks what is true of any triangulation of the whole triangle that has all points and segments.
void expectTriangulation(const Fixture& in, const Triangulation& out) {
  ASSERT_TRUE(out.isComplete());
  double area = 0.0;
  std::set<std::pair<std::uint32_t, std::uint32_t>> halfEdges;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::set<std::uint32_t> used;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> marked;
  std::size_t onBoundary = 0;
  for (std::size_t i = 0; i < out.triangles.size(); ++i) {
    const glm::uvec3& t = out.triangles[i];
    area += areaOf(in.points, t);
    EXPECT_EQ(orientation(in.points[t.x].point, in.points[t.y].point, in.points[t.z].point, 2), 1);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      EXPECT_TRUE(halfEdges.insert({a, b}).second);
      edges.insert(std::minmax(a, b));
      used.insert(a);
      const std::uint32_t segment = out.segments[i][k];
      if (segment == Triangulation::kNone) continue;
      EXPECT_EQ(std::minmax(a, b), std::minmax(in.segments[segment][0], in.segments[segment][1]));
      marked.insert({std::minmax(a, b), segment});
    }
  }
  for (const auto& p : in.points) onBoundary += p.edges != 0;
  EXPECT_EQ(used.size(), in.points.size());
  EXPECT_EQ(marked.size(), in.segments.size());
  // Euler: vertices - edges + triangles = 1 for a disk.
  EXPECT_EQ(used.size() + out.triangles.size(), edges.size() + 1);
  EXPECT_EQ(2 * edges.size() - halfEdges.size(), onBoundary);
  EXPECT_NEAR(area, 8.0, 1e-12 * 8.0);
}

TEST(Triangulate, ATriangleAloneStaysWhole) {
  const Fixture in;
  const Triangulation out = in.run();
  expectTriangulation(in, out);
  EXPECT_EQ(out.triangles.size(), 1u);
}

TEST(Triangulate, PointsOnEdgesSplitTheBoundary) {
  Fixture in;
  const auto a = in.add(1.0, 0.0, 0b001), b = in.add(3.0, 1.0, 0b010), c = in.add(0.0, 1.5, 0b100);
  in.segments = {{a, b}, {c, a}};
  expectTriangulation(in, in.run());
}

TEST(Triangulate, AClosedLoopInsideIsKept) {
  Fixture in;
  constexpr std::uint32_t kPoints = 40;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kPoints, radius = 0.3 + 0.6 * (i % 2);
    in.add(1.2 + radius * std::cos(angle), 1.2 + radius * std::sin(angle));
    in.segments.push_back({3 + i, 3 + (i + 1) % kPoints});
  }
  expectTriangulation(in, in.run());
}

TEST(Triangulate, SegmentsThatCrossManyEdgesAreKept) {
  Fixture in;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const double u = randomUnit(1, Stage::noise, 2 * i), v = randomUnit(1, Stage::noise, 2 * i + 1);
    in.add(0.1 + 1.5 * u, 0.1 + 1.5 * v);
  }
  // From left to right without crossings: by height, both ends.
  std::vector<std::uint32_t> left, right;
  for (std::uint32_t i = 0; i < 30; ++i) {
    left.push_back(in.add(0.05, 0.1 + 0.05 * i));
    right.push_back(in.add(1.7, 0.11 + 0.049 * i));
    in.segments.push_back({left.back(), right.back()});
  }
  expectTriangulation(in, in.run());
}

TEST(Triangulate, ManyPointsOnOneLineAreJoined) {
  Fixture in;
  std::uint32_t last = in.add(0.0, 1.0, 0b100);
  for (int i = 1; i < 300; ++i) {
    const std::uint32_t next = in.add(i / 100.0, 1.0);
    in.segments.push_back({last, next});
    last = next;
  }
  expectTriangulation(in, in.run());
}

TEST(Triangulate, AGridIsTriangulated) {
  Fixture in;
  for (int x = 1; x < 28; ++x) {
    for (int y = 1; x + y < 32; ++y) in.add(x / 8.0, y / 8.0);
  }
  expectTriangulation(in, in.run());
}

TEST(Triangulate, TrianglesFollowTheirSourceSeenFromBehind) {
  Fixture in;
  std::swap(in.points[1].point, in.points[2].point);  // edges 0 and 2 change places
  in.add(1.0, 1.0);
  in.add(1.0, 0.0, 0b100);
  in.segments = {{3, 4}};
  const Triangulation out = in.run();
  ASSERT_TRUE(out.isComplete());
  EXPECT_EQ(out.triangles.size(), 4u);
  for (const glm::uvec3& t : out.triangles) {
    EXPECT_EQ(orientation(in.points[t.x].point, in.points[t.y].point, in.points[t.z].point, 2), -1);
  }
}

TEST(Triangulate, CrossingSegmentsAreReported) {
  Fixture in;
  const auto a = in.add(0.5, 0.5), b = in.add(1.5, 1.5), c = in.add(0.5, 1.5), d = in.add(1.5, 0.5);
  in.segments = {{a, b}, {c, d}};
  const Triangulation out = in.run();
  ASSERT_EQ(out.crossing.size(), 1u);
  EXPECT_EQ(out.crossing[0], (std::array<std::uint32_t, 2>{0, 1}));
  EXPECT_TRUE(out.onSegment.empty());
}

TEST(Triangulate, APointOnASegmentIsReported) {
  Fixture in;
  const auto a = in.add(0.5, 0.5), b = in.add(1.5, 1.5), c = in.add(1.0, 1.0);
  in.segments = {{a, b}};
  const Triangulation out = in.run();
  ASSERT_EQ(out.onSegment.size(), 1u);
  EXPECT_EQ(out.onSegment[0], (std::array<std::uint32_t, 2>{c, 0}));
}

TEST(Triangulate, CoincidentPointsAreReported) {
  Fixture in;
  in.add(0.5, 0.5);
  in.add(0.5, 0.5);
  in.segments = {{3, 4}};
  EXPECT_EQ(in.run().coincident.size(), 1u);
}

TEST(Triangulate, ATriangleWithoutAreaIsReported) {
  Fixture in;
  in.points[2].point = ExactPoint({2.0, 0.0, 0.0});
  const Triangulation out = in.run();
  EXPECT_TRUE(out.isFlat);
  EXPECT_TRUE(out.triangles.empty());
}

TEST(Triangulate, PointsInsideNoCircleOfATriangle) {
  Fixture in;
  for (std::uint64_t i = 0; i < 300; ++i) {
    const double u = randomUnit(2, Stage::noise, 2 * i), v = randomUnit(2, Stage::noise, 2 * i + 1);
    in.add(0.1 + 1.5 * u, 0.1 + 1.5 * v);
  }
  const Triangulation out = in.run();
  expectTriangulation(in, out);
  for (const glm::uvec3& t : out.triangles) {
    const glm::dvec3 a = in.points[t.x].point.rounded, b = in.points[t.y].point.rounded - a,
                     c = in.points[t.z].point.rounded - a;
    const double twice = 2.0 * (b.x * c.y - b.y * c.x);
    const glm::dvec3 center((c.y * glm::dot(b, b) - b.y * glm::dot(c, c)) / twice,
                            (b.x * glm::dot(c, c) - c.x * glm::dot(b, b)) / twice, 0.0);
    const double radius = glm::length(center);
    if (radius > 100.0) continue;  // at the hull, too inexact for this test
    for (const TrianglePoint& p : in.points) {
      EXPECT_GE(glm::length(p.point.rounded - a - center), radius * (1.0 - 1e-9));
    }
  }
}

}  // namespace
}  // namespace sherd
