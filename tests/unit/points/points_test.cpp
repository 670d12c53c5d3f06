// Points on surfaces and in the space around meshes, against geometry and statistics.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/points.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "base/half_float.h"
#include "mesh/search/nearest_on_triangle.h"
#include "shapes.h"

namespace sherd {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

const std::vector<PointOptions> kEveryWay{
    {.sampler = PointSampler::uniform, .rule = PointRule::area},
    {.sampler = PointSampler::halton, .rule = PointRule::area},
    {.sampler = PointSampler::poisson, .rule = PointRule::area},
    {.sampler = PointSampler::uniform, .rule = PointRule::perTriangle},
    {.sampler = PointSampler::halton, .rule = PointRule::perTriangle}};

PointOptions with(PointOptions options, std::size_t count, std::uint64_t seed = 0) {
  options.count = count;
  options.seed = seed;
  return options;
}

// A distinct number per triangle, which identifies the triangle of a point.
TriangleMesh numbered(TriangleMesh mesh) {
  mesh.neighbor.resize(mesh.triangles.size());
  std::iota(mesh.neighbor.begin(), mesh.neighbor.end(), std::uint16_t{0});
  return mesh;
}

// Normal vector, twice the area long.
glm::dvec3 areaNormal(const TriangleMesh& mesh, std::size_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  return glm::cross(mesh.vertices[t.y] - mesh.vertices[t.x],
                    mesh.vertices[t.z] - mesh.vertices[t.x]);
}

// Barycentric coordinates of a point in the triangle's plane.
glm::dvec3 barycentric(const TriangleMesh& mesh, std::size_t triangle, const glm::dvec3& p) {
  const glm::uvec3& t = mesh.triangles[triangle];
  const glm::dvec3 a = mesh.vertices[t.x] - p, b = mesh.vertices[t.y] - p,
                   c = mesh.vertices[t.z] - p, n = areaNormal(mesh, triangle);
  return glm::dvec3(glm::dot(glm::cross(b, c), n), glm::dot(glm::cross(c, a), n),
                    glm::dot(glm::cross(a, b), n)) /
         glm::dot(n, n);
}

// Right triangles of the given areas, side by side in the plane z = 0.
TriangleMesh row(const std::vector<double>& areas) {
  TriangleMesh mesh;
  double x = 0.0;
  for (const double area : areas) {
    const auto first = static_cast<unsigned>(mesh.vertices.size());
    for (const glm::dvec3& v :
         {glm::dvec3(0, 0, 0), glm::dvec3(2.0 * area, 0, 0), glm::dvec3(0, 1, 0)}) {
      mesh.vertices.push_back(v + glm::dvec3(x, 0, 0));
    }
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    x += 2.0 * area;
  }
  return mesh;
}

template <class Work>
ErrorCode codeOf(const Work& work) {
  try {
    (void)work();
  } catch (const Error& e) {
    EXPECT_GT(std::string(e.what()).size(), 8u);
    return e.code();
  }
  return ErrorCode{0};
}

// ---- Points on surfaces

TEST(SamplePoints, HaveTheRequestedCountAndLieOnTheirTriangles) {
  const TriangleMesh ball = shapes::ball(2.0, 2, {1.0, -3.0, 0.5});
  for (const PointOptions& way : kEveryWay) {
    for (const std::size_t count : {0u, 1u, 2u, 319u, 320u, 321u, 5000u}) {
      const SurfacePoints points = samplePoints(numbered(ball), with(way, count));
      ASSERT_EQ(points.positions.size(), count);
      ASSERT_EQ(points.normals.size(), count);
      ASSERT_EQ(points.neighbor.size(), count);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t t = points.neighbor[i];
        const glm::dvec3& corner = ball.vertices[ball.triangles[t].x];
        const glm::dvec3 normal = glm::normalize(areaNormal(ball, t));
        // Coordinates are below 8; a few rounding errors.
        ASSERT_LT(std::abs(glm::dot(points.positions[i] - corner, normal)), 64.0 * kEpsilon);
        const glm::dvec3 b = barycentric(ball, t, points.positions[i]);
        ASSERT_GT(std::min({b.x, b.y, b.z}), -1e3 * kEpsilon);
        ASSERT_LT(glm::length(points.normals[i] - normal), 16.0 * kEpsilon);
      }
    }
  }
}

TEST(SamplePoints, HaveUnitNormalsThatPointOutOfABall) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  const SurfacePoints points = samplePoints(ball, {.count = 2000});
  for (std::size_t i = 0; i < points.normals.size(); ++i) {
    EXPECT_NEAR(glm::length(points.normals[i]), 1.0, 8.0 * kEpsilon);
    // A point and its facet's normal differ by at most the facet's width, about 0.15.
    EXPECT_GT(glm::dot(points.normals[i], points.positions[i]), 0.9);
    EXPECT_EQ(points.neighbor[i], 0);
  }
}

// Chi-square over 48 bins: a quarter of each of 12 triangles whose areas span 1 to 176.  By Laurent
// and Massart (2000), chi-square of k degrees is above k + 2 sqrt(k x) + 2x at most once in e^x.
//   areas  expected distribution over the triangles
double chiSquare(const SurfacePoints& points, const TriangleMesh& mesh,
                 const std::vector<double>& areas) {
  std::vector<double> counts(4 * mesh.triangles.size(), 0.0);
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const std::size_t t = points.neighbor[i];
    const glm::dvec3 b = barycentric(mesh, t, points.positions[i]);
    const std::size_t quarter = b.x > 0.5 ? 0 : b.y > 0.5 ? 1 : b.z > 0.5 ? 2 : 3;
    counts[4 * t + quarter] += 1.0;
  }
  double sum = 0.0;
  for (std::size_t bin = 0; bin < counts.size(); ++bin) {
    const double expected = static_cast<double>(points.positions.size()) * areas[bin / 4] / 4.0 /
                            std::accumulate(areas.begin(), areas.end(), 0.0);
    sum += (counts[bin] - expected) * (counts[bin] - expected) / expected;
  }
  return sum;
}

TEST(SamplePoints, AreUniformByArea) {
  std::vector<double> areas, others;
  for (int k = 0; k < 12; ++k) {
    areas.push_back(std::pow(1.6, k));
    others.push_back(std::pow(1.55, k));
  }
  const TriangleMesh mesh = row(areas);
  const double degrees = 47.0, x = std::log(1e6);
  const double bound = degrees + 2.0 * std::sqrt(degrees * x) + 2.0 * x;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    for (const PointSampler sampler : {PointSampler::uniform, PointSampler::halton}) {
      const PointOptions options{.count = 100'000, .sampler = sampler, .seed = seed};
      const SurfacePoints points = samplePoints(numbered(mesh), options);
      EXPECT_LT(chiSquare(points, mesh, areas), bound);
      EXPECT_GT(chiSquare(points, mesh, others),
                bound);  // the test is sensitive to a small difference
    }
  }
}

// The largest difference between the share of points in a box at the origin and the box's area,
// over all boxes with corners at coordinates of points, open and closed.
double starDiscrepancy(const std::vector<glm::dvec2>& points) {
  double worst = 0.0;
  const double share = 1.0 / static_cast<double>(points.size());
  const auto addBox = [&](double x, double y) {
    int open = 0, closed = 0;
    for (const glm::dvec2& p : points) {
      open += p.x < x && p.y < y;
      closed += p.x <= x && p.y <= y;
    }
    worst = std::max({worst, x * y - open * share, closed * share - x * y});
  };
  for (const glm::dvec2& a : points) {
    for (const glm::dvec2& b : points) addBox(a.x, b.y);
    addBox(a.x, 1.0);
    addBox(1.0, a.y);
  }
  return worst;
}

TEST(SamplePoints, OfHaltonHaveLessDiscrepancyThanMersenneTwister) {
  const TriangleMesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  constexpr std::size_t kCount = 256;
  double worstHalton = 0.0, bestTwister = 1.0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::vector<glm::dvec2> halton, twister;
    const PointOptions options{.count = kCount, .sampler = PointSampler::halton, .seed = seed};
    for (const glm::dvec3& p : samplePoints(square, options).positions) {
      halton.emplace_back(p.x, p.y);
    }
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform;
    for (std::size_t i = 0; i < kCount; ++i) {
      const double x = uniform(generator);
      twister.emplace_back(x, uniform(generator));
    }
    worstHalton = std::max(worstHalton, starDiscrepancy(halton));
    bestTwister = std::min(bestTwister, starDiscrepancy(twister));
  }
  EXPECT_LT(worstHalton, bestTwister);
}

double leastDistance(const SurfacePoints& points) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      least = std::min(least, glm::length(points.positions[i] - points.positions[j]));
    }
  }
  return least;
}

// r is the radius of n disks in their densest packing on the area A.  Among n uniform points, the
// number of pairs nearer than d is Poisson-distributed with mean n^2 pi d^2 / (2A).  For d = r / 10
// that is 0.0045 n = 9, so uniform points almost always have a nearer pair.
TEST(SamplePoints, OfPoissonAreFarApart) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  constexpr std::size_t kCount = 2000;
  const double r = std::sqrt(area(ball) / (2.0 * std::sqrt(3.0) * kCount));
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const auto distance = [&](PointSampler sampler) {
      return leastDistance(samplePoints(ball, {.count = kCount, .sampler = sampler, .seed = seed}));
    };
    EXPECT_GT(distance(PointSampler::poisson), r);
    EXPECT_LT(distance(PointSampler::uniform), r / 10.0);
  }
}

// All areas are powers of two: no count is rounded up, and no point is cut.
// Also far from the range of single precision.
TEST(SamplePoints, OfPoissonScaleWithTheMesh) {
  const TriangleMesh unit = shapes::ball(1.0, 3);
  const SurfacePoints expected =
      samplePoints(unit, {.count = 40, .sampler = PointSampler::poisson});
  for (const int exponent : {-100, 100}) {
    const double scale = std::ldexp(1.0, exponent);
    TriangleMesh mesh = unit;
    for (glm::dvec3& v : mesh.vertices) v *= scale;
    const SurfacePoints found = samplePoints(mesh, {.count = 40, .sampler = PointSampler::poisson});
    ASSERT_EQ(found.positions.size(), expected.positions.size());
    for (std::size_t i = 0; i < found.positions.size(); ++i) {
      EXPECT_EQ(found.positions[i], scale * expected.positions[i]);
    }
  }
}

TEST(SamplePoints, PerTriangleAreProportionalToAreaWithoutRounding) {
  const TriangleMesh mesh = row({1, 1, 2, 4, 8});
  for (const std::size_t each : {1u, 3u, 100u}) {
    const PointOptions options{.count = 16 * each, .rule = PointRule::perTriangle};
    std::vector<std::size_t> counts(5, 0);
    for (const std::uint16_t t : samplePoints(numbered(mesh), options).neighbor) ++counts[t];
    EXPECT_EQ(counts, (std::vector<std::size_t>{each, each, 2 * each, 4 * each, 8 * each}));
  }
}

// Each triangle gets at least one point, then 64 of all points are kept: a triangle of a millionth
// of the area keeps its point as often as any other.  20 triangles are small; the two large ones
// get 32 each, as 31.99 is rounded up.
TEST(SamplePoints, PerTriangleGiveEachOneBeforeTheCut) {
  std::vector<double> areas(22, 0x1p-20);
  areas[20] = areas[21] = 1.0;
  const TriangleMesh mesh = row(areas);
  constexpr int kSeeds = 500;
  constexpr double kShare = 64.0 / (20.0 + 2.0 * 32.0);
  std::vector<int> found(20, 0);
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const PointOptions options{.count = 64, .rule = PointRule::perTriangle, .seed = seed};
    for (const std::uint16_t t : samplePoints(numbered(mesh), options).neighbor) {
      if (t < 20) ++found[t];
    }
  }
  const double deviation = std::sqrt(kSeeds * kShare * (1.0 - kShare));
  for (const int n : found) EXPECT_NEAR(n, kSeeds * kShare, 5.0 * deviation);
}

TEST(SamplePoints, SkipTrianglesWithoutArea) {
  TriangleMesh mesh = row({1, 0, 2, 0});
  for (const PointOptions& way : kEveryWay) {
    const SurfacePoints points = samplePoints(numbered(mesh), with(way, 300));
    const std::set<std::uint16_t> triangles(points.neighbor.begin(), points.neighbor.end());
    EXPECT_EQ(triangles, (std::set<std::uint16_t>{0, 2}));
  }
}

TEST(SamplePoints, DependOnTheSeedOnly) {
  const TriangleMesh ball = shapes::ball(1.0, 2);
  for (const PointOptions& way : kEveryWay) {
    const SurfacePoints first = samplePoints(numbered(ball), with(way, 200, 5));
    const SurfacePoints again = samplePoints(numbered(ball), with(way, 200, 5));
    EXPECT_EQ(first.positions, again.positions);
    EXPECT_EQ(first.normals, again.normals);
    EXPECT_EQ(first.neighbor, again.neighbor);
    EXPECT_NE(first.positions, samplePoints(numbered(ball), with(way, 200, 6)).positions);
  }
}

// A power of two scales every product without rounding.
TEST(SamplePoints, MoveWithTheMesh) {
  const TriangleMesh ball = shapes::ball(1.0, 2), larger = shapes::transformed(ball, 4.0, {});
  for (const PointOptions& way : kEveryWay) {
    const SurfacePoints small = samplePoints(ball, with(way, 200));
    const SurfacePoints large = samplePoints(larger, with(way, 200));
    for (std::size_t i = 0; i < 200; ++i) {
      EXPECT_EQ(4.0 * small.positions[i], large.positions[i]);
      EXPECT_EQ(small.normals[i], large.normals[i]);
    }
  }
}

TEST(SamplePoints, RefuseInvalidOptions) {
  const TriangleMesh ball = shapes::ball(1.0, 1);
  const auto code = [](const TriangleMesh& mesh, const PointOptions& options) {
    return codeOf([&] { return samplePoints(mesh, options); });
  };
  EXPECT_EQ(code(ball, {.count = kMaxPoints + 1}), ErrorCode::usage);
  EXPECT_EQ(
      code(ball, {.count = 9, .sampler = PointSampler::poisson, .rule = PointRule::perTriangle}),
      ErrorCode::usage);
  EXPECT_EQ(code(row({0, 0}), {.count = 9}), ErrorCode::input);
}

TEST(ShareOut, RoundsDownThenServesTheLargestRemainders) {
  using Counts = std::vector<std::size_t>;
  EXPECT_EQ(shareOut(10, std::vector<double>{1, 1, 1}), (Counts{4, 3, 3}));
  EXPECT_EQ(shareOut(8, std::vector<double>{9, 6, 1}), (Counts{5, 3, 0}));  // 4.5, 3, 0.5
  EXPECT_EQ(shareOut(8, std::vector<double>{9, 5, 2}), (Counts{5, 2, 1}));  // 4.5, 2.5, 1
  EXPECT_EQ(shareOut(0, std::vector<double>{1, 2}), (Counts{0, 0}));
  std::mt19937 generator(1);
  std::exponential_distribution<double> areas;
  for (std::size_t total = 0; total < 2000; total += 37) {
    std::vector<double> all;
    for (int i = 0; i < 50; ++i) all.push_back(areas(generator));
    const double sum = std::accumulate(all.begin(), all.end(), 0.0);
    const Counts counts = shareOut(total, all);
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t{0}), total);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double share = all[i] / sum * static_cast<double>(total);
      EXPECT_LT(std::abs(static_cast<double>(counts[i]) - share), 1.0 + 1e-9);
    }
  }
}

// ---- Distances

std::vector<glm::dvec3> scattered(std::size_t count, double reach, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = uniform(generator);
  }
  return points;
}

double distanceToCube(const glm::dvec3& p, double half) {
  const glm::dvec3 q = glm::abs(p) - half;
  return glm::length(glm::max(q, 0.0)) + std::min(0.0, std::max({q.x, q.y, q.z}));
}

// Also on a lattice, where points have several closest faces and rays hit edges.
TEST(SignedDistances, AreExactOnACube) {
  const TriangleMesh cube = shapes::cube(2.0);
  std::vector<glm::dvec3> points = scattered(20000, 2.0);
  for (int x = -8; x <= 8; ++x) {
    for (int y = -8; y <= 8; ++y) {
      for (int z = -8; z <= 8; ++z) points.push_back(0.25 * glm::dvec3(x, y, z));
    }
  }
  // And so near to a face that single precision cannot decide the side.
  for (const double above : {1e-5, 1e-6, 1e-7, 1e-9, 1e-12}) {
    for (const glm::dvec3& p : scattered(50, 0.99)) {
      points.emplace_back(p.x, p.y, 1.0 + above);
      points.emplace_back(p.x, -1.0 + above, p.z);
    }
  }
  const std::vector<double> distances = signedDistances(cube, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double truth = distanceToCube(points[i], 1.0);
    if (truth == 0.0) {
      EXPECT_EQ(std::abs(distances[i]), 0.0);
    } else {
      EXPECT_NEAR(distances[i], truth, 16.0 * kEpsilon) << points[i].x << ' ' << points[i].y;
    }
  }
}

// The mesh lies between the sphere through its vertices and the sphere tangent to its faces, so its
// distance lies between theirs.
TEST(SignedDistances, OfABallLieBetweenThoseOfItsInnerAndOuterSpheres) {
  const glm::dvec3 middle(10.0, -20.0, 5.0);
  const TriangleMesh ball = shapes::ball(3.0, 3, middle);
  double inner = 3.0;
  for (std::size_t t = 0; t < ball.triangles.size(); ++t) {
    const glm::dvec3 corner = ball.vertices[ball.triangles[t].x] - middle;
    inner = std::min(inner, glm::dot(corner, glm::normalize(areaNormal(ball, t))));
  }
  std::vector<glm::dvec3> points = scattered(20000, 5.0);
  for (glm::dvec3& p : points) p += middle;
  const std::vector<double> distances = signedDistances(ball, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double radius = glm::length(points[i] - middle);
    EXPECT_GE(distances[i], radius - 3.0 - 1e-13);
    EXPECT_LE(distances[i], radius - inner + 1e-13);
  }
}

// Cavities are outside; overlaps of components are inside.
TEST(SignedDistances, AreNegativeWhereTheWindingNumberIsPositive) {
  const TriangleMesh hollow = shapes::hollowBall(1.0, 0.5, 3);
  const TriangleMesh two = shapes::append(shapes::cube(2.0), shapes::cube(2.0, {1.0, 0.0, 0.0}));
  const std::vector<glm::dvec3> points = scattered(5000, 2.5);
  const std::vector<double> ofHollow = signedDistances(hollow, points);
  const std::vector<double> ofTwo = signedDistances(two, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double radius = glm::length(points[i]);
    if (radius > 1.0 || radius < 0.48) {
      EXPECT_GT(ofHollow[i], 0.0);
    } else if (radius < 0.98 && radius > 0.5) {
      EXPECT_LT(ofHollow[i], 0.0);
    }
    const double nearer = std::min(distanceToCube(points[i], 1.0),
                                   distanceToCube(points[i] - glm::dvec3(1.0, 0.0, 0.0), 1.0));
    EXPECT_EQ(ofTwo[i] < 0.0, nearer < 0.0);
  }
}

TEST(SignedDistances, MatchBruteForceOverAllTriangles) {
  const TriangleMesh torus = shapes::torus(1.0, 0.3, 48, 24);
  const std::vector<glm::dvec3> points = scattered(300, 1.5);
  const std::vector<double> distances = signedDistances(torus, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const glm::uvec3& t : torus.triangles) {
      const glm::dvec3 at = nearestOnTriangle(points[i], torus.vertices[t.x], torus.vertices[t.y],
                                              torus.vertices[t.z]);
      nearest = std::min(nearest, glm::length(points[i] - at));
    }
    EXPECT_NEAR(std::abs(distances[i]), nearest, 16.0 * kEpsilon);
  }
}

TEST(SignedDistances, DoNotDependOnThreads) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  const DistanceOptions options{.count = 5000, .sigma = 0.05, .seed = 3};
  std::vector<DistanceSamples> samples;
  for (const int threads : {1, 2}) {
    tbb::task_arena arena(threads);
    samples.push_back(arena.execute([&] { return sampleDistances(ball, options); }));
    EXPECT_EQ(samples.front().positions, samples.back().positions);
    EXPECT_EQ(samples.front().distances, samples.back().distances);
  }
}

TEST(SignedDistances, StopOnCancellation) {
  const Progress stop{.report = {}, .cancelled = [] { return true; }};
  EXPECT_EQ(codeOf([&] { return signedDistances(shapes::cube(1.0), scattered(10, 1.0), &stop); }),
            ErrorCode::cancelled);
}

// ---- Distance samples

// Half of the points fill the box: their mean is its center, and they reach its sides.  The others
// are as far from the faces as they were moved, except near edges: sigma is so small that these are
// one in 500.
TEST(SampleDistances, FillTheBoxAndConcentrateAtTheSurface) {
  constexpr double kSigma = 1e-4;
  constexpr std::size_t kCount = 40000;
  const TriangleMesh cube = shapes::cube(1.0);
  const DistanceSamples samples = sampleDistances(cube, {.count = kCount, .sigma = kSigma});
  ASSERT_EQ(samples.positions.size(), kCount);
  ASSERT_EQ(samples.distances.size(), kCount);
  glm::dvec3 sum(0.0), low(1.0), high(-1.0);
  double squares[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < kCount; ++i) {
    const glm::dvec3& p = samples.positions[i];
    EXPECT_NEAR(samples.distances[i], distanceToCube(p, 0.5), 16.0 * kEpsilon);
    if (i % 2 == 0) {
      sum += p;
      low = glm::min(low, p);
      high = glm::max(high, p);
    } else {
      squares[i % 4 / 2] += samples.distances[i] * samples.distances[i];
    }
  }
  const double half = 0.55, n = kCount / 2.0;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sum[axis] / n, 0.0, 5.0 * half / std::sqrt(3.0 * n));
    // The probability that none of n lies within 30 / n of the side is e^-15.
    EXPECT_LT(low[axis], -half * (1.0 - 30.0 / n));
    EXPECT_GT(high[axis], half * (1.0 - 30.0 / n));
    EXPECT_GE(low[axis], -half - 1e-7);
    EXPECT_LE(high[axis], half + 1e-7);
  }
  const double tolerance =
      5.0 / std::sqrt(n) + 1.0 / 500.0;  // the relative error of a variance is sqrt(2 / n)
  EXPECT_NEAR(std::sqrt(squares[0] * 2.0 / n) / kSigma, 1.0, tolerance);
  EXPECT_NEAR(std::sqrt(squares[1] * 2.0 / n) / kSigma, 3.0, 3.0 * tolerance);
}

TEST(SampleDistances, AreThoseOfTheRoundedPoints) {
  const TriangleMesh cube = shapes::cube(1.0, {100.0, 0.0, 0.0});  // float16 steps are 1/16 there
  const DistanceSamples samples =
      sampleDistances(cube, {.count = 1000, .type = SampleType::float16, .sigma = 0.01});
  for (std::size_t i = 0; i < 1000; ++i) {
    const glm::dvec3& p = samples.positions[i];
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(roundedToHalf(p[axis]), p[axis]);
    EXPECT_NEAR(samples.distances[i], distanceToCube(p - glm::dvec3(100.0, 0.0, 0.0), 0.5),
                256.0 * kEpsilon);
  }
}

TEST(SampleDistances, RefuseInvalidOptions) {
  const auto code = [](const TriangleMesh& mesh, const DistanceOptions& options) {
    return codeOf([&] { return sampleDistances(mesh, options); });
  };
  const TriangleMesh cube = shapes::cube(1.0), far = shapes::cube(1.0, {65504.0, 0.0, 0.0});
  EXPECT_EQ(code(cube, {.count = 9}), ErrorCode::usage);  // sigma is 0
  EXPECT_EQ(code(cube, {.count = kMaxPoints + 1, .sigma = 1.0}), ErrorCode::usage);
  EXPECT_EQ(code(far, {.count = 9, .type = SampleType::float16, .sigma = 0.1}), ErrorCode::usage);
  EXPECT_EQ(code(far, {.count = 9, .sigma = 0.1}), ErrorCode{0});
  EXPECT_EQ(code(row({0, 0}), {.count = 9, .sigma = 0.1}), ErrorCode::input);
}

TEST(Half, RoundsToNearestAndEven) {
  const auto bits = [](double value) { return halfBits(roundedToHalf(value)); };
  EXPECT_EQ(bits(0.0), 0x0000);
  EXPECT_EQ(bits(-0.0), 0x8000);
  EXPECT_EQ(bits(1.0), 0x3c00);
  EXPECT_EQ(bits(-2.0), 0xc000);
  EXPECT_EQ(bits(1.0 / 3.0), 0x3555);
  EXPECT_EQ(bits(kLargestHalf), 0x7bff);
  EXPECT_EQ(bits(1.0 + 0x1p-11), 0x3c00);        // a tie goes to the even one
  EXPECT_EQ(bits(1.0 + 3.0 * 0x1p-11), 0x3c02);  // likewise
  EXPECT_EQ(bits(2.0 - 0x1p-12), 0x4000);        // up to the next power
  EXPECT_EQ(bits(0x1p-14), 0x0400);
  EXPECT_EQ(bits(0x1p-14 - 0x1p-26), 0x0400);
  EXPECT_EQ(bits(0x1p-24), 0x0001);
  EXPECT_EQ(bits(0x1p-25), 0x0000);
  EXPECT_EQ(bits(3.0 * 0x1p-25), 0x0002);
}

}  // namespace
}  // namespace sherd
