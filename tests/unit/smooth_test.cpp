// Laplacian smoothing.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/surface.h>

#include <algorithm>
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

std::vector<std::uint16_t> allFacing(const TriangleMesh& mesh, std::uint16_t facing) {
  return std::vector<std::uint16_t>(mesh.triangles.size(), facing);
}

TEST(Smooth, NothingMovesWithoutWeightOrIterations) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  std::vector<std::uint16_t> facing = allFacing(ball, 0);
  std::fill(facing.begin(), facing.begin() + 300, std::uint16_t{2});
  const TriangleMesh byDefault = smoothed(ball, facing, {}, kSide);
  EXPECT_EQ(byDefault.vertices, ball.vertices);
  const TriangleMesh weightless = smoothed(
      ball, facing,
      {.iterations = {9}, .weight = 0.0, .boundaryIterations = {9}, .boundaryWeight = 0.0}, kSide);
  EXPECT_EQ(weightless.vertices, ball.vertices);
  EXPECT_EQ(weightless.triangles, ball.triangles);
}

TEST(Smooth, OneStepGoesByTheWeightToTheNeighboursMean) {
  const TriangleMesh t = tetrahedron();
  for (const double weight : {0.25, 1.0}) {
    const TriangleMesh one =
        smoothed(t, allFacing(t, 0), {.iterations = {1}, .weight = weight}, kSide);
    const TriangleMesh boundary =
        smoothed(t, allFacing(t, 7), {.boundaryIterations = {1}, .boundaryWeight = weight}, kSide);
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
      smoothed(grid, allFacing(grid, 0), {.iterations = {iterations}}, kSide);
  int stayed = 0;
  for (std::size_t v = 0; v < grid.vertices.size(); ++v) {
    const glm::dvec3& p = grid.vertices[v];
    EXPECT_EQ(smooth.vertices[v].z, 0.0);
    // The open rim draws in, one ring further each time.
    const double fromRim = std::min({p.x, p.y, n - p.x, n - p.y});
    if (fromRim < iterations) continue;
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
    return smoothed(t, allFacing(t, 0), {.iterations = iterations}, 128).vertices;
  };
  EXPECT_EQ(after({.perVoxel = 0.048}), after({.count = 6}));
  EXPECT_NE(after({.perVoxel = 0.048}), after({.count = 5}));
}

TEST(Smooth, BoundaryVerticesAndOthersMoveOnTheirOwn) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  std::vector<std::uint16_t> facing(ball.triangles.size());
  std::set<unsigned> boundary;
  for (std::size_t t = 0; t < facing.size(); ++t) {
    const glm::uvec3& c = ball.triangles[t];
    facing[t] = ball.vertices[c.x].z > 0.2 ? 3 : 0;
    for (int k = 0; k < 3 && facing[t]; ++k) boundary.insert(c[k]);
  }
  const TriangleMesh others = smoothed(
      ball, facing, {.iterations = {4}, .boundaryIterations = {4}, .boundaryWeight = 0.0}, kSide);
  const TriangleMesh boundaries =
      smoothed(ball, facing, {.weight = 0.0, .boundaryIterations = {4}}, kSide);
  for (unsigned v = 0; v < ball.vertices.size(); ++v) {
    EXPECT_EQ(others.vertices[v] != ball.vertices[v], boundary.count(v) == 0) << v;
    EXPECT_EQ(boundaries.vertices[v] != ball.vertices[v], boundary.count(v) == 1) << v;
  }
  // A ball shrinks: a vertex goes to the mean of points inside.
  for (unsigned v = 0; v < ball.vertices.size(); ++v) {
    EXPECT_LE(glm::length(others.vertices[v]), glm::length(ball.vertices[v]));
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

VoxelMesh halfMesh(bool upper, int n) {
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

TEST(Smooth, TwoSidesOfAnInterfaceMoveAlikeAwayFromTheRim) {
  const int n = 20, iterations = 3;
  std::map<std::tuple<double, double, double>, glm::dvec3> moved[2];
  for (const bool upper : {false, true}) {
    const VoxelMesh half = halfMesh(upper, n);
    const TriangleMesh smooth = smoothed(
        half.mesh, half.facing, {.iterations = {6}, .boundaryIterations = {iterations}}, kSide);
    std::set<unsigned> ofCut;
    for (std::size_t t = 0; t < half.facing.size(); ++t) {
      for (int k = 0; k < 3 && half.facing[t]; ++k) ofCut.insert(half.mesh.triangles[t][k]);
    }
    for (const unsigned v : ofCut) {
      const glm::dvec3& p = half.mesh.vertices[v];
      const double fromRim = std::min({p.x, p.y, n - 1 - p.x, n - 1 - p.y}) + 0.5;
      // What a vertex sees reaches one more ring with each iteration.
      if (fromRim >= iterations) moved[upper][{p.x, p.y, p.z}] = smooth.vertices[v];
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
  for (const SurfaceOptions& bad :
       {SurfaceOptions{.smooth = {.weight = 1.1}}, SurfaceOptions{.smooth = {.weight = -0.1}},
        SurfaceOptions{.smooth = {.boundaryWeight = NAN}},
        SurfaceOptions{.smooth = {.iterations = {-1}}},
        SurfaceOptions{.smooth = {.boundaryIterations = {.perVoxel = 1.5}}},
        SurfaceOptions{.triangles = {3}}, SurfaceOptions{.triangles = {100, 100}}}) {
    EXPECT_THROW(checkSurfaceOptions(bad), Error);
  }
}

}  // namespace
}  // namespace sherd
