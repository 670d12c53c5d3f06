// Bodies that touch, overlap or lie within others, and are kept.
#include <gtest/gtest.h>
#include <sherd/fracture.h>
#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "intersect/self_crossings.h"
#include "kernels/device_fixture.h"
#include "mesh/positions.h"
#include "mesh/repair/bodies_apart.h"
#include "remesh/bodies.h"
#include "shapes.h"

namespace sherd {
namespace {

using KeptBodies = DeviceTest;

// Bodies, in units of which a voxel is one or so, and the pairs of them that touch or overlap.
struct Assembly {
  std::string name;
  std::vector<TriangleMesh> bodies;
  std::vector<std::array<std::size_t, 2>> contacts;
};

TriangleMesh boxFrom(const glm::dvec3& low, const glm::dvec3& high) {
  return shapes::transformed(shapes::box(high - low), 1.0, (low + high) / 2.0);
}

std::vector<Assembly> assemblies() {
  const TriangleMesh unit = boxFrom({0, 0, 0}, {12, 12, 12});
  return {
      {"a leg on a seat",
       {boxFrom({0, 0, 10}, {20, 20, 14}), boxFrom({2, 3, 0}, {7, 8, 10})},
       {{0, 1}}},
      {"a face in common", {unit, boxFrom({12, 0, 0}, {24, 12, 12})}, {{0, 1}}},
      {"an edge in common", {unit, boxFrom({12, 12, 0}, {24, 24, 12})}, {}},
      {"a vertex in common", {unit, boxFrom({12, 12, 12}, {24, 24, 24})}, {}},
      {"an overlap", {unit, boxFrom({7, 5, 3}, {19, 18, 15})}, {{0, 1}}},
      {"a pin in a block",
       {boxFrom({0, 0, 0}, {16, 16, 10}), boxFrom({6, 6, -5}, {10, 10, 15})},
       {{0, 1}}},
      {"a plate through a block",
       {boxFrom({0, 0, 0}, {24, 10, 10}), boxFrom({10, -1, -1}, {13, 11, 11})},
       {{0, 1}}},
      {"a ball in a box",
       {boxFrom({0, 0, 0}, {16, 16, 16}), shapes::ball(5.0, 2, {8, 8, 8})},
       {{0, 1}}},
      {"a ball that fills a cavity",
       {shapes::hollowBall(10.0, 6.0, 2), shapes::ball(6.0, 2)},
       {{0, 1}}},
      {"a box in the corner of another", {unit, boxFrom({0, 0, 0}, {6, 6, 6})}, {{0, 1}}},
      {"a row",
       {unit, boxFrom({12, 0, 0}, {24, 12, 12}), boxFrom({24, 0, 0}, {36, 12, 12}),
        boxFrom({6, 12, 0}, {30, 20, 12})},
       {{0, 1}, {1, 2}, {0, 3}, {1, 3}, {2, 3}}},
  };
}

// The bodies as a reader gives them: vertices at one position are one.
struct Joined {
  TriangleMesh mesh;
  std::vector<std::uint32_t> body;  // [triangles]
};

Joined joined(const std::vector<TriangleMesh>& bodies) {
  Joined all;
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    all.mesh = shapes::append(all.mesh, bodies[b]);
    all.body.resize(all.mesh.triangles.size(), b);
  }
  const std::vector<std::uint32_t> first = firstAtPosition(all.mesh.vertices);
  for (glm::uvec3& t : all.mesh.triangles) t = {first[t.x], first[t.y], first[t.z]};
  return all;
}

std::vector<TriangleMesh> rotated(std::vector<TriangleMesh> bodies) {
  const glm::dmat3 rotation = glm::mat3_cast(glm::normalize(glm::dquat(0.9, 0.1, 0.3, 0.2)));
  for (TriangleMesh& body : bodies) {
    for (glm::dvec3& v : body.vertices) v = rotation * v;
  }
  return bodies;
}

// Options that break bodies along planes, or rough cracks.
FractureOptions keptOptions(int pieces, bool isRough) {
  FractureOptions options{.pieces = pieces, .seed = 5, .solid = {.voxelSize = 1.0}};
  options.solid.bodies = MeetingBodies::keep;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  if (isRough) options.grow = {.growth = Growth::sequential, .roughness = 0.7};
  return options;
}

using Corners = std::array<std::tuple<double, double, double>, 3>;

Corners cornersOf(const TriangleMesh& mesh, const glm::uvec3& t, bool isReversed) {
  Corners corners;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3& v = mesh.vertices[t[isReversed ? 2 - k : k]];
    corners[static_cast<std::size_t>(k)] = {v.x, v.y, v.z};
  }
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

// Faces between fragments are those of both, bit for bit.
void expectSharedCracks(const std::vector<Fragment>& fragments) {
  std::set<std::tuple<int, int, Corners>> faces;
  for (const Fragment& f : fragments) {
    for (std::size_t t = 0; t < f.mesh.triangles.size(); ++t) {
      const int other = f.mesh.neighbor[t];
      if (other != 0) faces.insert({f.id, other, cornersOf(f.mesh, f.mesh.triangles[t], false)});
    }
  }
  for (const Fragment& f : fragments) {
    for (std::size_t t = 0; t < f.mesh.triangles.size(); ++t) {
      const int other = f.mesh.neighbor[t];
      if (other == 0) continue;
      ASSERT_TRUE(faces.contains({other, f.id, cornersOf(f.mesh, f.mesh.triangles[t], true)}));
    }
  }
}

// Each fragment is one body, of one body of the input, whose volumes are those of its fragments.
// Returns [fragments] these bodies.
std::vector<std::size_t> expectOfBodies(const std::vector<Fragment>& fragments,
                                        const std::vector<TriangleMesh>& bodies,
                                        const std::vector<std::uint32_t>& bodyOfTriangle) {
  std::vector<double> volumes(bodies.size(), 0.0);
  std::vector<std::size_t> bodyOf;
  for (const Fragment& fragment : fragments) {
    const TriangleMesh& mesh = fragment.mesh;
    EXPECT_EQ(openEdges(mesh), 0u) << fragment.id;
    EXPECT_EQ(nonManifoldEdges(mesh), 0u) << fragment.id;
    EXPECT_EQ(sherd::bodiesOf(mesh).size(), 1u) << fragment.id;
    std::set<std::size_t> own;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.source[t] == TriangleMesh::kNoSource) continue;
      own.insert(bodyOfTriangle[mesh.source[t]]);
      EXPECT_EQ(mesh.neighbor[t], 0);
    }
    EXPECT_EQ(own.size(), 1u) << fragment.id;
    bodyOf.push_back(own.empty() ? 0 : *own.begin());
    volumes[bodyOf.back()] += volume(mesh);
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    EXPECT_NEAR(volumes[b], volume(bodies[b]), 1e-9 * volume(bodies[b])) << b;
  }
  return bodyOf;
}

TEST_F(KeptBodies, AreBrokenEachForItself) {
  for (const Assembly& assembly : assemblies()) {
    for (const bool isRough : {false, true}) {
      SCOPED_TRACE(assembly.name + (isRough ? ", rough" : ", planar"));
      const std::vector<TriangleMesh> bodies = isRough ? rotated(assembly.bodies) : assembly.bodies;
      const Joined all = joined(bodies);
      FractureOptions options = keptOptions(9, isRough);
      const FractureResult result = fracture(all.mesh, options, device());
      ASSERT_EQ(result.exactFailure, "");
      EXPECT_EQ(result.solid.report.keptBodies, bodies.size());
      EXPECT_EQ(result.solid.report.hiddenBodies, 0u);
      EXPECT_EQ(result.united.before, 0u);
      const std::vector<std::size_t> bodyOf = expectOfBodies(result.fragments, bodies, all.body);
      expectSharedCracks(result.fragments);
      std::set<std::array<std::size_t, 2>> contacts;
      for (const Fragment& f : result.fragments) {
        for (const Contact& contact : f.contacts) {
          const std::size_t a = bodyOf[static_cast<std::size_t>(f.id) - 1],
                            b = bodyOf[static_cast<std::size_t>(contact.fragment) - 1];
          if (a < b) contacts.insert({a, b});
        }
      }
      // Voxels of bodies that have an edge in common may lie side by side.
      for (const auto& pair : assembly.contacts) EXPECT_TRUE(contacts.contains(pair));
      if (bodies.size() > 2) {
        EXPECT_EQ(contacts.size(), assembly.contacts.size());
      }
    }
  }
}

TEST_F(KeptBodies, HaveAPieceEachAndTheRestByVolume) {
  const std::vector<TriangleMesh> bodies{boxFrom({0, 0, 0}, {30, 12, 12}),
                                         boxFrom({30, 0, 0}, {40, 12, 12}),
                                         boxFrom({40, 4, 4}, {44, 8, 8})};
  const Joined all = joined(bodies);
  for (const int pieces : {1, 3, 17}) {
    const FractureResult result = fracture(all.mesh, keptOptions(pieces, false), device());
    ASSERT_EQ(result.fragments.size(), static_cast<std::size_t>(std::max(pieces, 3)));
    std::map<std::size_t, int> count;
    for (const std::size_t body : expectOfBodies(result.fragments, bodies, all.body)) ++count[body];
    EXPECT_EQ(count.size(), 3u);
    if (pieces != 17) continue;
    // 14 seeds anywhere: their numbers have a standard deviation of 1.6.
    EXPECT_NEAR(count[0], 14 * 0.74 + 1, 5.0);
    EXPECT_NEAR(count[1], 14 * 0.25 + 1, 5.0);
  }
}

TEST_F(KeptBodies, WithoutVoxelsOfTheirOwnAreLeftOut) {
  const TriangleMesh box = boxFrom({0, 0, 0}, {12, 12, 12});
  for (const TriangleMesh& second : {box, boxFrom({3, 3, 12}, {6, 6, 12.001})}) {
    const Joined all = joined({box, second});
    const FractureResult result = fracture(all.mesh, keptOptions(4, false), device());
    ASSERT_EQ(result.exactFailure, "");
    EXPECT_EQ(result.solid.report.keptBodies, 2u);
    EXPECT_EQ(result.solid.report.hiddenBodies, 1u);
    std::vector<std::uint32_t> first(all.mesh.triangles.size(), 0);
    (void)expectOfBodies(result.fragments, {box}, first);
  }
}

TEST_F(KeptBodies, ErodeAtTheirCracksOnly) {
  const std::vector<TriangleMesh> bodies{boxFrom({0, 0, 0}, {16, 16, 10}),
                                         boxFrom({3, 3, -6}, {13, 13, 16})};
  const std::vector<std::uint32_t> bodyOfTriangle = joined(bodies).body;
  FractureOptions options = keptOptions(2, false);
  options.erode.iterations = 1;
  const FractureResult whole = fracture(joined(bodies).mesh, options, device());
  EXPECT_EQ(whole.eroded.front(), 0u);
  options.pieces = 8;
  const FractureResult result = fracture(joined(bodies).mesh, options, device());
  ASSERT_EQ(result.exactFailure, "");
  EXPECT_GT(result.eroded.front(), 0u);
  std::vector<std::uint32_t> bodyOf;
  for (const Fragment& f : result.fragments) {
    EXPECT_EQ(openEdges(f.mesh), 0u);
    EXPECT_EQ(sherd::bodiesOf(f.mesh).size(), 1u);
    const auto own = std::ranges::find_if(
        f.mesh.source, [](std::uint32_t t) { return t != TriangleMesh::kNoSource; });
    bodyOf.push_back(bodyOfTriangle[*own]);
  }
  for (const Fragment& f : result.fragments) {  // also where voxels are those of the other body
    for (const std::uint16_t other : f.mesh.neighbor) {
      if (other == 0) continue;
      ASSERT_EQ(bodyOf[other - 1u], bodyOf[static_cast<std::size_t>(f.id) - 1]);
    }
  }
}

TEST_F(KeptBodies, SmoothFragmentsAreOfOneBody) {
  for (const Assembly& assembly : assemblies()) {
    SCOPED_TRACE(assembly.name);
    const Joined all = joined(assembly.bodies);
    FractureOptions options = keptOptions(7, false);
    options.surface.surface = Surface::smooth;
    const FractureResult result = fracture(all.mesh, options, device());
    EXPECT_EQ(result.solid.report.keptBodies, assembly.bodies.size());
    EXPECT_GE(result.components, assembly.bodies.size());
    for (const Fragment& f : result.fragments) EXPECT_EQ(openEdges(f.mesh), 0u);
  }
}

TEST_F(KeptBodies, OfOpenMeshesAreNotKnown) {
  TriangleMesh open = joined(assemblies().front().bodies).mesh;
  open.triangles.pop_back();
  const FractureResult result = fracture(open, keptOptions(4, false), device());
  EXPECT_TRUE(result.solid.report.lacksBodies);
  EXPECT_EQ(result.solid.report.keptBodies, 0u);
  EXPECT_FALSE(fracture(joined(assemblies().front().bodies).mesh, keptOptions(4, false), device())
                   .solid.report.lacksBodies);
}

TEST(BodiesApart, ShareNoVertices) {
  for (const Assembly& assembly : assemblies()) {
    for (const bool isRotated : {false, true}) {
      for (const bool hasObjects : {false, true}) {
        SCOPED_TRACE(assembly.name);
        const Joined all = joined(isRotated ? rotated(assembly.bodies) : assembly.bodies);
        const TriangleMesh apart =
            withBodiesApart(all.mesh, hasObjects ? all.body : std::vector<std::uint32_t>{});
        std::map<std::uint32_t, std::set<std::uint32_t>> bodies;
        const MeshComponents components = meshComponents(apart);
        for (std::size_t t = 0; t < all.body.size(); ++t) {
          bodies[components.ofTriangle[t]].insert(all.body[t]);
          for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(apart.vertices[apart.triangles[t][k]],
                      all.mesh.vertices[all.mesh.triangles[t][k]]);
          }
        }
        for (const auto& [component, own] : bodies) EXPECT_EQ(own.size(), 1u);
        EXPECT_EQ(openEdges(apart), 0u);
      }
    }
  }
}

// Four bodies at an edge, eight at a vertex; oriented outwards, or inwards as a whole.
TEST(BodiesApart, FillSpace) {
  std::vector<TriangleMesh> cells;
  for (int i = 0; i < 27; ++i) {
    cells.push_back(shapes::cube(1.0, glm::dvec3(i % 3, i / 3 % 3, i / 9)));
  }
  for (const std::vector<TriangleMesh>& bodies : {cells, rotated(cells)}) {
    const TriangleMesh all = joined(bodies).mesh;
    EXPECT_EQ(meshComponents(withBodiesApart(all)).count, 27u);
    EXPECT_EQ(meshComponents(withBodiesApart(shapes::inverted(all))).count, 27u);
  }
}

// Copies of a body are bodies; a sheet that is there twice is none.
TEST(BodiesApart, CopiesAreBodiesAndSheetsAreNot) {
  const TriangleMesh ball = shapes::ball(1.0, 2);
  EXPECT_EQ(meshComponents(withBodiesApart(joined({ball, ball, ball}).mesh)).count, 3u);
  TriangleMesh leaf = shapes::cube(1.0);
  for (const bool isReversed : {true, false}) {
    const glm::uvec3& t = leaf.triangles.front();
    leaf.triangles.push_back(isReversed ? glm::uvec3(t.x, t.z, t.y) : t);
  }
  EXPECT_EQ(meshComponents(withBodiesApart(leaf)).count, 1u);
}

// A surface that is divided into open objects, as by its materials, is one body.
TEST(BodiesApart, OpenObjectsStayTogether) {
  const TriangleMesh ball = shapes::ball(1.0, 2);
  std::vector<std::uint32_t> objects(ball.triangles.size(), 0);
  for (std::size_t t = 0; t < objects.size(); t += 3) objects[t] = 1;
  const TriangleMesh apart = withBodiesApart(ball, objects);
  EXPECT_EQ(apart.triangles, ball.triangles);
  EXPECT_EQ(apart.vertices, ball.vertices);
}

}  // namespace
}  // namespace sherd
