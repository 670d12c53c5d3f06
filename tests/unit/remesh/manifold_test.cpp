// Closed meshes whose sheets touch, with vertices for each sheet.
#include "remesh/manifold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <tuple>
#include <vector>

#include "base/random.h"
#include "mesh_checks.h"
#include "shapes.h"

namespace sherd {
namespace {

// Equal positions become one vertex.
LabeledMesh merged(const TriangleMesh& mesh) {
  LabeledMesh out;
  std::map<std::tuple<double, double, double>, std::uint32_t> number;
  const auto numberOf = [&](std::uint32_t v) {
    const glm::dvec3& p = mesh.vertices[v];
    const auto [at, isNew] =
        number.insert({{p.x, p.y, p.z}, static_cast<std::uint32_t>(out.mesh.vertices.size())});
    if (isNew) {
      out.mesh.vertices.push_back(p);
      out.positionId.push_back(at->second);
    }
    return at->second;
  };
  for (const glm::uvec3& t : mesh.triangles) {
    out.mesh.triangles.emplace_back(numberOf(t.x), numberOf(t.y), numberOf(t.z));
  }
  return out;
}

TriangleMesh unitCubes(const std::vector<glm::dvec3>& centers) {
  TriangleMesh all;
  for (const glm::dvec3& center : centers) all = shapes::append(all, shapes::cube(1.0, center));
  return all;
}

// The surface of the unit voxels for which a condition holds, each face of two triangles.
TriangleMesh voxelSurface(int side, const std::function<bool(int, int, int)>& isInside) {
  TriangleMesh out;
  const auto within = [&](const glm::ivec3& v) {
    return std::min({v.x, v.y, v.z}) >= 0 && std::max({v.x, v.y, v.z}) < side &&
           isInside(v.x, v.y, v.z);
  };
  for (int i = 0; i < side * side * side; ++i) {
    const glm::ivec3 v(i / (side * side), i / side % side, i % side);
    if (!within(v)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      for (int up = 0; up < 2; ++up) {
        glm::ivec3 step(0), u(0), w(0);
        step[axis] = 2 * up - 1;
        u[(axis + 1) % 3] = w[(axis + 2) % 3] = 1;
        if (within(v + step)) continue;
        glm::ivec3 corner = v;
        corner[axis] += up;
        if (up == 0) std::swap(u, w);
        const auto first = static_cast<std::uint32_t>(out.vertices.size());
        for (const glm::ivec3& p : {corner, corner + u, corner + u + w, corner + w}) {
          out.vertices.emplace_back(p);
        }
        out.triangles.emplace_back(first, first + 1, first + 2);
        out.triangles.emplace_back(first, first + 2, first + 3);
      }
    }
  }
  return out;
}

// Expects a manifold mesh with the same triangles, by position.
void expectMadeManifold(const LabeledMesh& before, LabeledMesh& mesh) {
  ASSERT_TRUE(makeManifold(mesh));
  expectClosedManifold(mesh.mesh);
  ASSERT_EQ(mesh.mesh.triangles.size(), before.mesh.triangles.size());
  ASSERT_EQ(mesh.positionId.size(), mesh.mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.mesh.vertices.size(); ++v) {
    EXPECT_EQ(mesh.mesh.vertices[v], before.mesh.vertices[mesh.positionId[v]]);
  }
  for (std::size_t t = 0; t < mesh.mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(mesh.positionId[mesh.mesh.triangles[t][k]], before.mesh.triangles[t][k]);
    }
  }
}

TEST(Manifold, CubesThatShareAVertexOrAnEdgeAreSeparated) {
  for (const glm::dvec3& other : {glm::dvec3(1, 1, 1), glm::dvec3(1, 1, 0)}) {
    const LabeledMesh before = merged(unitCubes({{0, 0, 0}, other}));
    EXPECT_GT(nonManifoldVertices(before.mesh), 0u);
    LabeledMesh mesh = before;
    expectMadeManifold(before, mesh);
    EXPECT_EQ(mesh.mesh.vertices.size(), 16u);
    EXPECT_EQ(meshComponents(mesh.mesh).count, 2u);
  }
}

TEST(Manifold, TheInsideConnectsTrianglesAlongALine) {
  // Two columns that share a line of two edges stay apart; two cavities like them become one.
  const auto isInColumns = [](int x, int y, int z) {
    return z >= 1 && z <= 2 && ((x == 1 && y == 1) || (x == 2 && y == 2));
  };
  const auto isAround = [&](int x, int y, int z) { return !isInColumns(x, y, z); };
  for (const auto& [isInside, components] :
       {std::pair<std::function<bool(int, int, int)>, std::size_t>{isInColumns, 2},
        {isAround, 2}}) {  // the outer surface and a cavity
    const LabeledMesh before = merged(voxelSurface(4, isInside));
    LabeledMesh mesh = before;
    expectMadeManifold(before, mesh);
    EXPECT_EQ(meshComponents(mesh.mesh).count, components);
  }
}

TEST(Manifold, TetrahedraAroundAnEdgeAreSeparated) {
  for (const int count : {2, 3, 7}) {
    TriangleMesh all;
    for (int i = 0; i < count; ++i) {
      const double angle = 0.3 + 2.0 * std::numbers::pi * i / count, width = 2.0 / count;
      const auto at = [](double a) { return glm::dvec3(std::cos(a), std::sin(a), 0.5); };
      all = shapes::append(all, {{{0, 0, 0}, {0, 0, 1}, at(angle), at(angle + width)},
                                 {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}});
    }
    ASSERT_GT(volume(all), 0.0);
    const LabeledMesh before = merged(all);
    EXPECT_EQ(before.mesh.vertices.size(), 2u + 2u * static_cast<std::size_t>(count));
    LabeledMesh mesh = before;
    expectMadeManifold(before, mesh);
    EXPECT_EQ(meshComponents(mesh.mesh).count, static_cast<std::size_t>(count));
  }
}

TEST(Manifold, AnEdgeBetweenSheetsThatMeetAtBothEndsIsSplit) {
  // Two voxels that share an edge, between two plates: around both ends of the edge all triangles
  // are one fan if those with the inside between them are connected at the edge.
  const LabeledMesh before = merged(voxelSurface(
      3, [](int x, int y, int z) { return z != 1 || (x == 0 && y == 0) || (x == 1 && y == 1); }));
  LabeledMesh mesh = before;
  expectMadeManifold(before, mesh);
}

TEST(Manifold, SurfacesOfRandomVoxelsAreMadeManifold) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const LabeledMesh before = merged(voxelSurface(5, [&](int x, int y, int z) {
      const auto item = static_cast<std::uint64_t>((x * 8 + y) * 8 + z);
      return randomUnit(seed, Stage::noise, item) < 0.2 + 0.03 * static_cast<double>(seed);
    }));
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    LabeledMesh mesh = before;
    expectMadeManifold(before, mesh);
    if (HasFailure()) return;
  }
}

TEST(Manifold, AManifoldMeshKeepsItsVertices) {
  LabeledMesh mesh = merged(shapes::torus(1.0, 0.3, 12, 8));
  const LabeledMesh before = mesh;
  expectMadeManifold(before, mesh);
  EXPECT_EQ(mesh.mesh.vertices, before.mesh.vertices);
}

TEST(Manifold, AMeshThatIsNotClosedIsNotChanged) {
  LabeledMesh open = merged(unitCubes({{0, 0, 0}, {1, 1, 0}}));
  open.mesh.triangles.pop_back();
  LabeledMesh flipped = merged(shapes::cube(1.0));
  std::swap(flipped.mesh.triangles[3].x, flipped.mesh.triangles[3].y);
  for (LabeledMesh& mesh : {std::ref(open), std::ref(flipped)}) {
    const LabeledMesh before = mesh;
    EXPECT_FALSE(makeManifold(mesh));
    EXPECT_EQ(mesh.mesh.vertices, before.mesh.vertices);
    EXPECT_EQ(mesh.mesh.triangles, before.mesh.triangles);
    EXPECT_EQ(mesh.positionId, before.positionId);
  }
}

}  // namespace
}  // namespace sherd
