// Decimation.
#include <gtest/gtest.h>
#include <sherd/fragments.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "mesh_checks.h"
#include "shapes.h"
#include "surface/label_mesh.h"

namespace sherd {
namespace {

// Of a unit cube: some thousand collapses, each of which may round its place by a few 1e-16.
constexpr double kExact = 1e-12;

// A cube of n^3 voxels, side 1, each side neighbor a fragment of its own where asked for.
TriangleMesh fineCube(int n, bool bySide) {
  std::vector<VoxelFace> faces;
  for (int d = 0; d < 6; ++d) {
    for (int u = 0; u < n; ++u) {
      for (int v = 0; v < n; ++v) {
        openvdb::Coord voxel;
        voxel[d / 2] = d % 2 ? n - 1 : 0;
        voxel[(d / 2 + 1) % 3] = u;
        voxel[(d / 2 + 2) % 3] = v;
        faces.push_back({voxel, d, static_cast<std::uint16_t>(bySide ? d : 0)});
      }
    }
  }
  return meshOfFaces(faces, {{}, 1.0 / n});
}

TriangleMesh decimatedTo(const TriangleMesh& mesh, std::size_t triangles) {
  return decimated(mesh, std::vector{triangles}).front();
}

// How far a face of a mesh of that many equilateral triangles lies inside the unit ball whose area
// they share, its corners on the sphere: the sagitta over the circumscribed circle.
double sagitta(std::size_t triangles) {
  const double each = 4 * std::numbers::pi / static_cast<double>(triangles);
  const double edgeSquared = 4 * each / std::numbers::sqrt3;
  return 1 - std::sqrt(1 - edgeSquared / 3);
}

TEST(Decimate, AFineCubeBecomesTheCube) {
  for (const bool bySide : {false, true}) {
    const TriangleMesh fine = fineCube(16, bySide);
    ASSERT_EQ(fine.triangles.size(), 6u * 16 * 16 * 2);
    for (const std::size_t triangles : {1000u, 100u, 12u}) {
      SCOPED_TRACE(triangles);
      const TriangleMesh coarse = decimatedTo(fine, triangles);
      EXPECT_LE(coarse.triangles.size(), triangles);
      expectClosedManifold(coarse);
      EXPECT_NEAR(volume(coarse), 1.0, kExact);
      EXPECT_NEAR(area(coarse), 6.0, kExact);
      if (!bySide) continue;
      for (const auto& [side, size] : areas(coarse)) {
        EXPECT_NEAR(size, 1.0, kExact);
      }
    }
  }
}

TEST(Decimate, ABallStaysNearTheBall) {
  const TriangleMesh ball = shapes::ball(1.0, 5);
  const std::vector<std::size_t> triangles{200, 5000, 1000};  // in any order
  const std::vector<TriangleMesh> coarse = decimated(ball, triangles);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    SCOPED_TRACE(triangles[i]);
    const TriangleMesh& mesh = coarse[i];
    EXPECT_EQ(mesh.triangles.size(), triangles[i]);  // even, and one collapse takes two
    expectClosedManifold(mesh);
    EXPECT_EQ(mesh.vertices.size(), mesh.triangles.size() / 2 + 2);  // Euler: still a ball
    EXPECT_NEAR(volume(mesh), shapes::ballVolume(1.0),
                sagitta(triangles[i]) * shapes::ballArea(1.0));
    for (const glm::uvec3& t : mesh.triangles) {  // outwards, every face
      const glm::dvec3 a = mesh.vertices[t.x];
      EXPECT_GT(glm::dot(a, glm::cross(mesh.vertices[t.y] - a, mesh.vertices[t.z] - a)), 0.0);
    }
  }
  // Each goes on from the larger one: alone it comes out the same.
  const TriangleMesh alone = decimatedTo(ball, 200);
  EXPECT_EQ(alone.vertices, coarse[0].vertices);
  EXPECT_EQ(alone.triangles, coarse[0].triangles);
}

TEST(Decimate, TurnsNoBodyInsideOut) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    TriangleMesh sliver = shapes::ball(1.0, 1);
    for (std::size_t i = 0; i < sliver.vertices.size(); ++i) {
      sliver.vertices[i] *= 0.2 + 0.8 * static_cast<double>(mixed(seed * 1000 + i) % 1000) / 1000.0;
      sliver.vertices[i].z *= 0.03;
    }
    const TriangleMesh fewest = decimatedTo(sliver, 4);
    EXPECT_GT(volume(fewest), 0.05 * volume(sliver)) << seed;
  }
}

TEST(Decimate, RegionsStayWhatTheyAre) {
  const TriangleMesh ball = shapes::ball(1.0, 5);
  std::vector<std::uint16_t> neighbor;
  for (const glm::uvec3& t : ball.triangles) {  // a half, two quarters, and a spot in the half
    const glm::dvec3 p =
        glm::normalize(ball.vertices[t.x] + ball.vertices[t.y] + ball.vertices[t.z]);
    neighbor.push_back(p.z > 0.0 ? (p.z > 0.9 ? 4 : 0) : (p.x > 0.0 ? 2 : 7));
  }
  const TriangleMesh withIds = shapes::withNeighbor(ball, neighbor);
  const auto before = areas(withIds);
  for (const std::size_t triangles : {2000u, 400u}) {
    SCOPED_TRACE(triangles);
    const TriangleMesh coarse = decimatedTo(withIds, triangles);
    EXPECT_LE(coarse.triangles.size(), triangles);
    expectClosedManifold(coarse);
    EXPECT_EQ(regions(coarse), regions(withIds));
    // Areas scale with the square of the distance, and rims (at most two great circles' length for
    // a region) move no farther than faces do.
    const double off = sagitta(triangles);
    for (const auto& [id, size] : areas(coarse)) {
      EXPECT_NEAR(size, before.at(id), off * (2 * size + 4 * std::numbers::pi)) << id;
    }
  }
}

TEST(Decimate, WhatCannotBeLessStaysMore) {
  const TriangleMesh sides = fineCube(4, true);
  const TriangleMesh cube = decimatedTo(sides, 4);
  EXPECT_EQ(cube.triangles.size(), 12u);  // eight corners where three regions meet
  expectClosedManifold(cube);
  EXPECT_NEAR(volume(cube), 1.0, kExact);

  const TriangleMesh ball = shapes::ball(1.0, 3);
  const TriangleMesh tetrahedron = decimatedTo(ball, 4);
  expectClosedManifold(tetrahedron);
  EXPECT_GE(tetrahedron.triangles.size(), 4u);

  const TriangleMesh ring = shapes::torus(1.0, 0.4);
  const TriangleMesh torus = decimatedTo(ring, 4);
  expectClosedManifold(torus);
  EXPECT_EQ(torus.vertices.size() * 2, torus.triangles.size());  // Euler: one hole
}

TEST(Decimate, ASmallMeshStaysToTheBit) {
  const TriangleMesh ball = shapes::ball(0.3, 2, {5.0, 6.0, 7.0});
  const TriangleMesh same = decimatedTo(ball, ball.triangles.size());
  EXPECT_EQ(same.vertices, ball.vertices);
  EXPECT_EQ(same.triangles, ball.triangles);
}

TEST(Decimate, ATouchingPairOfSheetsDoesNotConfuseIt) {
  std::vector<VoxelFace> faces;  // of a checkerboard: sheets part everywhere
  for (int i = 0; i < 64; ++i) {
    const openvdb::Coord voxel(i >> 4, (i >> 2) & 3, i & 3);
    if ((voxel.x() + voxel.y() + voxel.z()) % 2) continue;
    for (int d = 0; d < 6; ++d) faces.push_back({voxel, d, static_cast<std::uint16_t>(d % 3)});
  }
  const TriangleMesh board = meshOfFaces(faces, {});
  const TriangleMesh coarse = decimatedTo(board, 4);
  expectClosedManifold(coarse);
  EXPECT_EQ(meshComponents(coarse).count, meshComponents(board).count);
}

}  // namespace
}  // namespace sherd
