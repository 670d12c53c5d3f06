// Meshes of bare labels: Surface::labels.
#include <gtest/gtest.h>

#include <set>

#include "kernels/voxel_shapes.h"
#include "mesh_checks.h"
#include "surface/label_mesh.h"

namespace sherd {
namespace {

using openvdb::Coord;

const Coord kLevelSteps[6] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

std::vector<VoxelFace> facesOfSet(const std::set<Coord>& voxels) {
  std::vector<VoxelFace> faces;
  for (const Coord& voxel : voxels) {
    for (int d = 0; d < 6; ++d) {
      if (!voxels.count(voxel + kLevelSteps[d])) faces.push_back({voxel, d, 0});
    }
  }
  return faces;
}

// Whatever touches over edges and corners: closed, manifold in edges and vertices, each vertex at a
// place of its own, outwards.  With sheets not set apart the volume and the area are the voxels'.
void expectGoodMesh(const std::set<Coord>& voxels) {
  const std::vector<VoxelFace> faces = facesOfSet(voxels);
  const TriangleMesh apart = meshOfFaces(faces, {});
  expectClosedManifold(apart);
  EXPECT_EQ(coincidentVertices(apart), 0u);
  const TriangleMesh exact = meshOfFaces(faces, {}, 0.0);
  const auto count = static_cast<double>(voxels.size());
  EXPECT_NEAR(volume(exact), count, 1e-12 * count);
  EXPECT_NEAR(area(exact), static_cast<double>(faces.size()), 1e-12 * area(exact));
  // No vertex has moved more than 1/64, so no face has swept more than that over its area, which
  // itself has grown by less than one part in eight.
  EXPECT_NEAR(volume(apart), count, area(exact) * 1.125 / 64);
  EXPECT_EQ(apart.triangles, exact.triangles);
}

TEST(LabelMesh, IsAManifoldForAllWaysRoundACorner) {
  for (unsigned mask = 1; mask < 256; ++mask) {
    SCOPED_TRACE(mask);
    std::set<Coord> voxels;
    for (int k = 0; k < 8; ++k) {
      if (mask >> k & 1) voxels.insert(Coord(k >> 2, (k >> 1) & 1, k & 1));
    }
    expectGoodMesh(voxels);
  }
}

TEST(LabelMesh, IsAManifoldForRandomVoxels) {
  for (unsigned percent : {5u, 20u, 50u, 80u, 95u}) {
    SCOPED_TRACE(percent);
    expectGoodMesh(voxel_shapes::sparseRandom(6, percent, percent).inside);
  }
  expectGoodMesh(voxel_shapes::checkerboard(5).inside);
  expectGoodMesh(voxel_shapes::manyComponentsWithin(8).inside);
}

TEST(LabelMesh, PartsSheetsThatHangTogetherBeyondBothEndsOfTheirEdge) {
  std::set<Coord> voxels{{0, 0, 1}, {1, 1, 1}};  // they touch over an edge, between two plates
  for (const int z : {0, 2}) {
    for (const int x : {0, 1}) {
      for (const int y : {0, 1}) voxels.insert({x, y, z});
    }
  }
  expectGoodMesh(voxels);
}

TEST(LabelMesh, LiesInTheWorldAsTheVoxelsDo) {
  const GridFrame frame{{10.0, 20.0, 30.0}, 0.5};
  const std::set<Coord> one{{2, 0, -1}};
  const Box box = bounds(meshOfFaces(facesOfSet(one), frame));
  EXPECT_EQ(box.min, glm::dvec3(10.75, 19.75, 29.25));
  EXPECT_EQ(box.max, glm::dvec3(11.25, 20.25, 29.75));
}

}  // namespace
}  // namespace sherd
