// Creases of the input in the fragments' meshes.
#include "interface/cells/creases.h"

#include <gtest/gtest.h>
#include <sherd/files.h>
#include <sherd/fracture.h>
#include <sherd/fragments.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <vector>

#include "interface/cells/contact_boundaries.h"
#include "intersect/self_crossings.h"
#include "kernels/device_fixture.h"
#include "mesh/search/triangle_tree.h"
#include "mesh_checks.h"
#include "remesh/bodies.h"
#include "remesh/resample/resample.h"
#include "shapes.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const glm::dmat3 kRotation =
    glm::mat3_cast(glm::angleAxis(0.7, glm::normalize(glm::dvec3(1.0, 2.0, 4.0))));

TriangleMesh rotated(TriangleMesh mesh) {
  for (glm::dvec3& v : mesh.vertices) v = kRotation * v;
  return mesh;
}

// The faces of fragments without a neighbor.
TriangleMesh originalSurface(const std::vector<Fragment>& fragments) {
  TriangleMesh all;
  for (const Fragment& fragment : fragments) {
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), fragment.mesh.vertices.begin(),
                        fragment.mesh.vertices.end());
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      if (fragment.mesh.neighbor[t] == 0)
        all.triangles.push_back(fragment.mesh.triangles[t] + first);
    }
  }
  return all;
}

// Distances from points on the edges of a cube to a surface, ascending.
std::vector<double> fromEdges(double side, const TriangleMesh& surface) {
  const TriangleTree tree(surface);
  std::vector<double> all;
  for (int axis = 0; axis < 3; ++axis) {
    for (int edge = 0; edge < 4; ++edge) {
      for (int i = 0; i <= 200; ++i) {
        glm::dvec3 at;
        at[axis] = side * (i / 200.0 - 0.5);
        at[(axis + 1) % 3] = side * (edge % 2 - 0.5);
        at[(axis + 2) % 3] = side * (edge / 2 - 0.5);
        all.push_back(tree.nearest(kRotation * at, kInfinity).distance);
      }
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

class CreasesOfFragments : public DeviceTest {
 protected:
  FractureResult broken(const TriangleMesh& mesh, Interface interface = Interface::shared,
                        double adaptivity = kAutoAdaptivity) {
    FractureOptions options;
    options.pieces = 8;
    options.seed = 3;
    options.solid.resolution = 64;
    options.surface.interface = interface;
    options.surface.adaptivity = adaptivity;
    return fracture(mesh, options, device());
  }
};

// A tenth of a voxel is the promise for 95 of 100 points of edges, half a voxel for all: the tip of
// an edge between voxel centers outside is cut off.
TEST_F(CreasesOfFragments, EdgesOfACubeStay) {
  constexpr double kSide = 2.0;
  for (const Interface interface : {Interface::shared, Interface::independent}) {
    const FractureResult result = broken(rotated(shapes::cube(kSide)), interface);
    const double h = result.solid.frame.voxelSize;
    const std::vector<double> distances = fromEdges(kSide, originalSurface(result.fragments));
    EXPECT_LT(distances[distances.size() * 95 / 100], 0.1 * h);
    const double moved = interface == Interface::shared ? 0.0 : kMostOffFeature;
    EXPECT_LT(distances.back(), (0.5 + moved) * h);
    double volumeSum = 0.0;
    for (const Fragment& fragment : result.fragments) {
      expectClosedManifold(fragment.mesh);
      volumeSum += volume(fragment.mesh);
    }
    // Twelve edges, rounded off by 0.4 voxel, would lose 12 * 2 * 0.3 h^2.
    if (interface == Interface::shared) {
      EXPECT_NEAR(volumeSum, 8.0, 0.5 * h * h);
    }
  }
}

// Where a crack meets the surface outside its cell, its vertex stays on the surface.
TEST_F(CreasesOfFragments, CracksEndOnTheFacesOfACube) {
  constexpr double kSide = 2.0;
  const FractureResult result = broken(rotated(shapes::cube(kSide)), Interface::shared, 0.0);
  const double h = result.solid.frame.voxelSize;
  std::size_t count = 0, off = 0;
  for (const Fragment& fragment : result.fragments) {
    const TriangleMesh& mesh = fragment.mesh;
    std::vector<int> sides(mesh.vertices.size(), 0);  // 1: original, 2: of a crack
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) sides[mesh.triangles[t][k]] |= mesh.neighbor[t] == 0 ? 1 : 2;
    }
    for (std::size_t v = 0; v < sides.size(); ++v) {
      const glm::dvec3 at = glm::abs(glm::transpose(kRotation) * mesh.vertices[v]);
      std::array<double, 3> depth{kSide / 2 - at.x, kSide / 2 - at.y, kSide / 2 - at.z};
      std::sort(depth.begin(), depth.end());
      if (sides[v] != 3 || depth[1] < h) continue;  // at the edges
      ++count;
      if (std::abs(depth[0]) > 0.01 * h) ++off;
    }
  }
  EXPECT_GT(count, 500u);
  // Not where triangles leave no room: 6 of 100, and 9 if junctions only moved towards targets.
  EXPECT_LT(off, count * 15 / 200) << count;
}

TEST(Creases, AreOnTheInput) {
  const Solid solid = voxelize(rotated(shapes::cube(2.0)), {.resolution = 64});
  const Creases creases(solid, leafNeighbors(solid.blocks->origins), nullptr);
  std::size_t count = 0;
  for (const openvdb::Coord& origin : solid.blocks->origins) {
    for (const CreaseVertex& vertex : creases.of(origin)) {
      const openvdb::Coord cell = origin + coordFromOffset(vertex.offset);
      const glm::dvec3 at = glm::dvec3(cell.x(), cell.y(), cell.z()) + vertex.at;
      if (vertex.rank == 1) continue;
      ++count;
      EXPECT_LT(solid.region->boundary()->nearest(at, 1.0).distance, 0.002) << cell;  // voxels
    }
  }
  EXPECT_GT(count, 500u);
}

// Beside the long box a cube, whose edges along z pass through centers of voxels: there the
// distances are those of one plane.
TEST(Creases, StayWhereTheyPassThroughVoxelCenters) {
  TriangleMesh mesh = shapes::cube(1.0);
  for (glm::dvec3& v : mesh.vertices) v = (v + 0.5) * glm::dvec3(64.0, 10.0, 10.0);
  mesh = shapes::append(mesh, shapes::cube(10.0, {20.5, 25.5, 5.5}));
  const Solid solid = voxelize(mesh, {.resolution = 64});
  const TriangleMesh surface = solidMesh(solid, 0.0);
  expectClosedManifold(surface);
  const TriangleTree tree(surface);
  for (const glm::dvec2 corner :
       {glm::dvec2(15.5, 20.5), {25.5, 20.5}, {15.5, 30.5}, {25.5, 30.5}}) {
    for (double z = 2.0; z <= 9.0; z += 0.25) {
      EXPECT_LT(tree.nearest({corner.x, corner.y, z}, kInfinity).distance, 0.01) << corner.x << z;
    }
  }
}

TEST(Creases, DoNotMakeTrianglesCross) {
  const Solid solid = voxelize(rotated(shapes::cup(1.0, 0.25, 1.5, 0.25, 40)), {.resolution = 64});
  const TriangleMesh mesh = solidMesh(solid);
  expectClosedManifold(mesh);
  EXPECT_TRUE(selfCrossings(mesh.vertices, mesh.triangles).empty());
}

// Gears that overlap leave cavities around single voxels: the planes on a voxel's six edges may
// meet on the other side of one another.
TEST(Creases, DoNotTurnCavitiesAroundOneVoxelInsideOut) {
  const char* folder = std::getenv("SHERD_TEST_DATA");
  if (folder == nullptr) GTEST_SKIP() << "SHERD_TEST_DATA names no folder of meshes";
  const TriangleMesh mesh = readMesh(std::filesystem::path(folder) / "cycloidal.ply").mesh;
  const TriangleMesh surface = solidMesh(voxelize(mesh, {.resolution = 64}), 0.0);
  EXPECT_EQ(bodiesOf(surface).size(), 1u);
}

TEST_F(CreasesOfFragments, AreTheSameForOneFractureOrSeveral) {
  const FractureResult result = broken(rotated(shapes::cup(1.0, 0.25, 1.5, 0.25, 40)));
  const auto intact = intactSurface(result.solid);
  const std::vector<Fragment> again =
      extractFragments(result.solid, result.labels, {.intact = intact});
  ASSERT_EQ(again.size(), result.fragments.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].mesh.vertices, result.fragments[i].mesh.vertices);
    EXPECT_EQ(again[i].mesh.triangles, result.fragments[i].mesh.triangles);
  }
}

// A solid of a ball has no creases, and a shell none where its input has one: the surface is an
// offset.
TEST(Creases, AreOnlyWhereTheInputBoundsTheSolid) {
  const auto ranks = [](const TriangleMesh& mesh, const SolidOptions& options) {
    const Solid solid = voxelize(mesh, options);
    const Creases creases(solid, leafNeighbors(solid.blocks->origins), nullptr);
    std::array<std::size_t, 4> count{};
    for (const openvdb::Coord& origin : solid.blocks->origins) {
      for (const CreaseVertex& vertex : creases.of(origin)) ++count[vertex.rank];
    }
    return count;
  };
  const auto ofBall = ranks(shapes::ball(1.0, 5), {.resolution = 48});
  EXPECT_EQ(ofBall[2] + ofBall[3], 0u);
  const auto ofCube = ranks(rotated(shapes::cube(2.0)), {.resolution = 48});
  EXPECT_EQ(ofCube[3], 8u);
  EXPECT_GT(ofCube[2], 12u * 20u);
  const auto ofShell = ranks(rotated(shapes::cube(2.0)), {.resolution = 48, .fill = Fill::shell});
  EXPECT_EQ(ofShell[1] + ofShell[2] + ofShell[3], 0u);
}

TEST(Quads, AreSplitAlongACreaseUnlessThatFolds) {
  const std::vector<glm::dvec3> convex{{0, 0, 0}, {1, 0, 0}, {1.2, 1.2, 0}, {0, 1, 0}};
  InterfaceQuad quad{1, 0, {0, 1, 2, 3}, 2, QuadSplit::shorter};
  EXPECT_EQ(trianglesOf(quad, convex)[0], (std::array<std::uint32_t, 3>{1, 2, 3}));
  quad.split = QuadSplit::first;
  EXPECT_EQ(trianglesOf(quad, convex)[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  // Vertex 2 within the triangle of the others: only the diagonal at it lies in the quad.
  const std::vector<glm::dvec3> dented{{0, 0, 0}, {1, 0, 0}, {0.3, 0.3, 0}, {0, 1, 0}};
  for (const QuadSplit split : {QuadSplit::shorter, QuadSplit::first, QuadSplit::second}) {
    quad.split = split;
    EXPECT_EQ(trianglesOf(quad, dented)[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  }
  // Vertices 0, 1 and 2 on a straight crease: a triangle of them would have no area.
  const std::vector<glm::dvec3> straight{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}};
  quad.split = QuadSplit::first;
  EXPECT_EQ(trianglesOf(quad, straight)[0], (std::array<std::uint32_t, 3>{1, 2, 3}));
}

// Through the diagonal of a square that two triangles share.
TEST(TriangleTree, SegmentsMeetEdges) {
  TriangleMesh square;
  square.vertices = {{0, 0, 0.3}, {1, 0, 0.3}, {1, 1, 0.3}, {0, 1, 0.3}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const TriangleTree tree(square);
  for (int i = 0; i <= 100; ++i) {
    const double at = i / 100.0;
    const auto hit = tree.firstBetween({at, at, 1.0}, {at, at, 0.0});
    ASSERT_TRUE(hit.has_value()) << at;
    EXPECT_NEAR(hit->at, 0.7, 1e-12);
    EXPECT_EQ(tree.source(hit->triangle), 0u);
  }
  EXPECT_FALSE(tree.firstBetween({0.5, 0.5, 1.0}, {0.5, 0.5, 0.4}).has_value());
  EXPECT_FALSE(tree.firstBetween({1.5, 0.5, 1.0}, {1.5, 0.5, 0.0}).has_value());
}

}  // namespace
}  // namespace sherd
