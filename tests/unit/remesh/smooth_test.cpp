// Smoothing.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/fragments.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "mesh_checks.h"
#include "shapes.h"
#include "surface/label_mesh.h"

namespace sherd {
namespace {

using openvdb::Coord;

constexpr int kSide = 100;  // of no matter where iterations are counts

// Quads of n x n in the plane z = 0, each split at one diagonal.
TriangleMesh flatGrid(int n) {
  TriangleMesh mesh;
  for (int x = 0; x <= n; ++x) {
    for (int y = 0; y <= n; ++y) mesh.vertices.push_back({x, y, 0});
  }
  const auto at = [n](int x, int y) { return static_cast<unsigned>(x * (n + 1) + y); };
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return mesh;
}

TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

TEST(Smooth, NothingMovesWithoutWeightOrIterations) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  std::vector<std::uint16_t> neighbor(ball.triangles.size(), 0);
  std::fill(neighbor.begin(), neighbor.begin() + 300, std::uint16_t{2});
  const TriangleMesh byDefault = smoothed(shapes::withNeighbor(ball, neighbor), {}, kSide);
  EXPECT_EQ(byDefault.vertices, ball.vertices);
  const TriangleMesh weightless = smoothed(
      shapes::withNeighbor(ball, neighbor),
      {.iterations = {9}, .weight = 0.0, .boundaryIterations = {9}, .boundaryWeight = 0.0}, kSide);
  EXPECT_EQ(weightless.vertices, ball.vertices);
  EXPECT_EQ(weightless.triangles, ball.triangles);
}

TEST(Smooth, OneStepGoesByTheWeightToTheNeighborsMean) {
  const TriangleMesh t = tetrahedron();
  for (const double weight : {0.25, 1.0}) {
    const TriangleMesh one =
        smoothed(t, {.iterations = {1}, .weight = weight, .method = Smoothing::laplacian}, kSide);
    const TriangleMesh boundary = smoothed(
        shapes::withNeighbor(t, {7, 7, 7, 7}),
        {.boundaryIterations = {1}, .boundaryWeight = weight, .method = Smoothing::laplacian},
        kSide);
    for (std::size_t v = 0; v < 4; ++v) {
      glm::dvec3 mean(0.0);  // of the other three, as they were before
      for (std::size_t n = 0; n < 4; ++n) {
        if (n != v) mean += t.vertices[n] / 3.0;
      }
      const glm::dvec3 want = (1.0 - weight) * t.vertices[v] + weight * mean;
      EXPECT_LT(glm::length(one.vertices[v] - want), 1e-15 * 8);
      EXPECT_LT(glm::length(boundary.vertices[v] - want), 1e-15 * 8);
    }
  }
}

TEST(Smooth, TheInsideOfAFlatGridStays) {
  const int n = 12, iterations = 3;
  const TriangleMesh grid = flatGrid(n);
  const TriangleMesh smooth =
      smoothed(grid, {.iterations = {iterations}, .method = Smoothing::laplacian}, kSide);
  int stayed = 0;
  for (std::size_t v = 0; v < grid.vertices.size(); ++v) {
    const glm::dvec3& p = grid.vertices[v];
    EXPECT_EQ(smooth.vertices[v].z, 0.0);
    // The open rim draws in, one ring further each time.
    const double fromBoundary = std::min({p.x, p.y, n - p.x, n - p.y});
    if (fromBoundary < iterations) continue;
    ++stayed;
    EXPECT_LT(glm::length(smooth.vertices[v] - p), 1e-14 * n);
  }
  EXPECT_EQ(stayed, 7 * 7);
}

TEST(Smooth, IterationsGrowWithTheLongestSide) {
  // The paper's: 0.048 k is 6 at 128 voxels, and 0.015 k in its program is 1.
  EXPECT_EQ((Iterations{.perVoxel = 0.048}.over(128)), 6);
  EXPECT_EQ((Iterations{.perVoxel = 0.015}.over(128)), 1);
  EXPECT_EQ((Iterations{.count = 3}.over(128)), 3);
  const TriangleMesh t = tetrahedron();
  const auto after = [&](Iterations iterations) {
    return smoothed(t, {.iterations = iterations}, 128).vertices;
  };
  EXPECT_EQ(after({.perVoxel = 0.048}), after({.count = 6}));
  EXPECT_NE(after({.perVoxel = 0.048}), after({.count = 5}));
}

TEST(Smooth, BoundaryVerticesAndOthersMoveOnTheirOwn) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  std::vector<std::uint16_t> neighbor(ball.triangles.size());
  std::set<unsigned> boundary;
  for (std::size_t t = 0; t < neighbor.size(); ++t) {
    const glm::uvec3& c = ball.triangles[t];
    neighbor[t] = ball.vertices[c.x].z > 0.2 ? 3 : 0;
    for (int k = 0; k < 3 && neighbor[t]; ++k) boundary.insert(c[k]);
  }
  const TriangleMesh others = smoothed(shapes::withNeighbor(ball, neighbor),
                                       {.iterations = {4},
                                        .boundaryIterations = {4},
                                        .boundaryWeight = 0.0,
                                        .method = Smoothing::laplacian},
                                       kSide);
  const TriangleMesh boundaries =
      smoothed(shapes::withNeighbor(ball, neighbor),
               {.weight = 0.0, .boundaryIterations = {4}, .method = Smoothing::laplacian}, kSide);
  for (unsigned v = 0; v < ball.vertices.size(); ++v) {
    EXPECT_EQ(others.vertices[v] != ball.vertices[v], boundary.count(v) == 0) << v;
    EXPECT_EQ(boundaries.vertices[v] != ball.vertices[v], boundary.count(v) == 1) << v;
  }
  // A ball shrinks: a vertex goes to the mean of points inside.
  for (unsigned v = 0; v < ball.vertices.size(); ++v) {
    EXPECT_LE(glm::length(others.vertices[v]), glm::length(ball.vertices[v]));
  }
}

// A torus as far as neighbors go: n x m vertices, each with six.  A coordinate that is a wave of p
// periods along n and q along m goes, with each step of weight w, to 1 - w k times itself.
struct Waves {
  int n, m;
  TriangleMesh mesh{};

  Waves(int columns, int rows) : n(columns), m(rows) {
    const auto at = [&](int x, int y) { return static_cast<unsigned>(x % n * m + y % m); };
    for (int x = 0; x < n; ++x) {
      for (int y = 0; y < m; ++y) {
        mesh.vertices.emplace_back(wave(1, 0, x, y), wave(2, 3, x, y), wave(n / 2, m / 2, x, y));
        mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
        mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
      }
    }
  }

  double phase(int p, int of) const { return 2.0 * M_PI * p / of; }
  double wave(int p, int q, int x, int y) const {
    return std::cos(phase(p, n) * x + phase(q, m) * y);
  }
  double eigenvalue(int p, int q) const {
    const double a = phase(p, n), b = phase(q, m);
    return 1.0 - (std::cos(a) + std::cos(b) + std::cos(a + b)) / 3.0;
  }
};

TEST(Smooth, WavesGoByTheTransferFunction) {
  const Waves waves(8, 24);
  const double lambda = 0.5, mu = 1.0 / (kPassBand - 1.0 / lambda);
  const int iterations = 10;
  const auto smooth = [&](Smoothing method, int count) {
    return smoothed(waves.mesh, {.iterations = {count}, .weight = lambda, .method = method}, kSide);
  };
  const TriangleMesh taubin = smooth(Smoothing::taubin, iterations);
  const TriangleMesh laplacian = smooth(Smoothing::laplacian, 2 * iterations);
  const std::array<double, 3> k{waves.eigenvalue(1, 0), waves.eigenvalue(2, 3),
                                waves.eigenvalue(4, 12)};
  for (std::size_t v = 0; v < waves.mesh.vertices.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      const double before = waves.mesh.vertices[v][axis], own = k[static_cast<std::size_t>(axis)];
      // Sums of twelve terms, 20 times: rounding grows by no more than a bit each time.
      EXPECT_NEAR(taubin.vertices[v][axis],
                  before * std::pow((1.0 - lambda * own) * (1.0 - mu * own), iterations), 1e-13);
      EXPECT_NEAR(laplacian.vertices[v][axis],
                  before * std::pow(1.0 - lambda * own, 2 * iterations), 1e-13);
    }
  }
  // A rod eight vertices round: of its width 95 % stay, of that of the other 13 %.
  EXPECT_GT(taubin.vertices[0].x, 0.95);
  EXPECT_LT(laplacian.vertices[0].x, 0.13);
}

TEST(Smooth, NoWaveGrowsByMuchWithAnyWeightThatIsAllowed) {
  for (const double lambda : {0.1, 0.5, kMostTaubinWeight}) {
    const double mu = 1.0 / (kPassBand - 1.0 / lambda);
    // The peak lies in the middle of the pass band.
    const double most = 1.0 - lambda * mu * kPassBand * kPassBand / 4.0;
    for (int i = 0; i <= 1000; ++i) {
      const double k = 2.0 * i / 1000;
      EXPECT_LE(std::abs((1.0 - lambda * k) * (1.0 - mu * k)), most + 1e-15) << lambda << ' ' << k;
    }
  }
}

// By how much a volume grows at most where no wave grows by more than the transfer function's peak.
double mostGrowth(int iterations) {
  const double lambda = SmoothOptions().weight, mu = 1.0 / (kPassBand - 1.0 / lambda);
  return std::pow(1.0 - lambda * mu * kPassBand * kPassBand / 4.0, 3 * iterations) - 1.0;
}

TEST(Smooth, TaubinsKeepsTheVolumeOfABall) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  double shortest = 1.0;
  for (const glm::uvec3& t : ball.triangles) {
    for (int k = 0; k < 3; ++k) {
      shortest =
          std::min(shortest, glm::length(ball.vertices[t[k]] - ball.vertices[t[(k + 1) % 3]]));
    }
  }
  const int iterations = 10;
  const double lambda = SmoothOptions().weight;
  const auto volumeBy = [&](Smoothing method, int count) {
    return volume(
        smoothed(ball, {.iterations = {count}, .weight = lambda, .method = method}, kSide));
  };
  const double most = mostGrowth(iterations);
  EXPECT_NEAR(volumeBy(Smoothing::taubin, iterations) / volume(ball), 1.0, most);
  // The mean of points a chord c away lies c^2 / 2 below the vertex.
  const double kept = std::pow(1.0 - lambda * shortest * shortest / 2.0, 3 * 2 * iterations);
  EXPECT_LT(volumeBy(Smoothing::laplacian, 2 * iterations) / volume(ball), kept);
  EXPECT_LT(kept, 1.0 - 2.0 * most);
}

// A plate of voxels, two thick, and a cup with a wall of two and a half.
TEST(Smooth, TaubinsKeepsThinWalls) {
  std::vector<TriangleMesh> thin;
  thin.push_back(solidMesh(voxelize(shapes::cup(1.0, 0.1, 1.5, 0.1, 64), {.resolution = 50}), 0.0));
  std::vector<VoxelFace> faces;
  const int n = 40, height = 2;
  const auto isIn = [&](const Coord& c) {
    return c.x() >= 0 && c.y() >= 0 && c.z() >= 0 && c.x() < n && c.y() < n && c.z() < height;
  };
  const Coord steps[6] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < height; ++z) {
        for (int d = 0; d < 6; ++d) {
          if (!isIn(Coord(x, y, z) + steps[d])) faces.push_back({{x, y, z}, d, 0});
        }
      }
    }
  }
  thin.push_back(meshOfFaces(faces, {}));
  const int iterations = 10;
  for (const TriangleMesh& mesh : thin) {
    const double before = volume(mesh);
    const auto kept = [&](Smoothing method, int count) {
      return volume(smoothed(mesh, {.iterations = {count}, .method = method}, kSide)) / before;
    };
    EXPECT_NEAR(kept(Smoothing::taubin, iterations), 1.0, mostGrowth(iterations));
    EXPECT_LT(kept(Smoothing::laplacian, 2 * iterations), 1.0 - 2.0 * mostGrowth(iterations));
  }
}

// A block of voxels cut by a bumpy surface into two: the lower and the upper.
std::set<Coord> halfBlock(bool upper, int n) {
  std::set<Coord> voxels;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      const int height =
          6 + static_cast<int>(std::lround(2 * std::sin(0.7 * x) * std::cos(0.5 * y)));
      for (int z = upper ? height : 0; z < (upper ? 12 : height); ++z) voxels.insert({x, y, z});
    }
  }
  return voxels;
}

TriangleMesh halfMesh(bool upper, int n) {
  const std::set<Coord> own = halfBlock(upper, n), other = halfBlock(!upper, n);
  const Coord steps[6] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  std::vector<VoxelFace> faces;
  for (const Coord& voxel : own) {
    for (int d = 0; d < 6; ++d) {
      const Coord beyond = voxel + steps[d];
      if (own.count(beyond)) continue;
      faces.push_back({voxel, d, static_cast<std::uint16_t>(other.count(beyond) ? 9 : 0)});
    }
  }
  return meshOfFaces(faces, {}, /*apart=*/0.0);
}

TEST(Smooth, TwoSidesOfAnInterfaceMoveAlikeAwayFromTheBoundary) {
  const int n = 20, iterations = 3;
  std::map<std::tuple<double, double, double>, glm::dvec3> moved[2];
  for (const bool upper : {false, true}) {
    const TriangleMesh half = halfMesh(upper, n);
    const TriangleMesh smooth = smoothed(
        half,
        {.iterations = {6}, .boundaryIterations = {iterations}, .method = Smoothing::laplacian},
        kSide);
    std::set<unsigned> ofCut;
    for (std::size_t t = 0; t < half.neighbor.size(); ++t) {
      for (int k = 0; k < 3 && half.neighbor[t]; ++k) ofCut.insert(half.triangles[t][k]);
    }
    for (const unsigned v : ofCut) {
      const glm::dvec3& p = half.vertices[v];
      const double fromBoundary = std::min({p.x, p.y, n - 1 - p.x, n - 1 - p.y}) + 0.5;
      // What a vertex sees reaches one more ring with each iteration.
      if (fromBoundary >= iterations) moved[upper][{p.x, p.y, p.z}] = smooth.vertices[v];
    }
  }
  ASSERT_GT(moved[0].size(), 150u);
  ASSERT_EQ(moved[0].size(), moved[1].size());
  std::size_t stayed = 0;
  for (const auto& [place, to] : moved[0]) {
    ASSERT_TRUE(moved[1].count(place));
    EXPECT_LT(glm::length(moved[1][place] - to), 1e-13);  // the sums' order differs, no more
    stayed += to == glm::dvec3(std::get<0>(place), std::get<1>(place), std::get<2>(place));
  }
  EXPECT_LT(stayed, moved[0].size() / 2);
}

TEST(Smooth, OptionsOutOfRangeAreRefused) {
  EXPECT_NO_THROW(checkSurfaceOptions({}));
  EXPECT_NO_THROW(
      checkSurfaceOptions({.smooth = {.iterations = {1}, .weight = kMostTaubinWeight}}));
  EXPECT_NO_THROW(checkSurfaceOptions({.smooth = {.weight = 1.0, .method = Smoothing::laplacian}}));
  // A weight without iterations moves nothing.
  EXPECT_NO_THROW(checkSurfaceOptions({.smooth = {.weight = 0.9, .boundaryWeight = 0.9}}));
  EXPECT_NO_THROW(checkSurfaceOptions({.smooth = {.iterations = {1}, .boundaryWeight = 0.9}}));
  for (const SurfaceOptions& bad :
       {SurfaceOptions{.smooth = {.weight = 1.1, .method = Smoothing::laplacian}},
        SurfaceOptions{.smooth = {.iterations = {1}, .weight = 0.7}},
        SurfaceOptions{.smooth = {.iterations = {.perVoxel = 0.1}, .weight = 0.7}},
        SurfaceOptions{.smooth = {.boundaryIterations = {1}, .boundaryWeight = 0.9}},
        SurfaceOptions{.smooth = {.weight = -0.1}},
        SurfaceOptions{.smooth = {.boundaryWeight = NAN}},
        SurfaceOptions{.smooth = {.iterations = {-1}}},
        SurfaceOptions{.smooth = {.boundaryIterations = {.perVoxel = 1.5}}},
        SurfaceOptions{.triangles = {3}}, SurfaceOptions{.triangles = {100, 100}}}) {
    EXPECT_THROW(checkSurfaceOptions(bad), Error);
  }
}

}  // namespace
}  // namespace sherd
