// Bodies of fragments that no crack connects to the rest.
#include "remesh/parts/loose_bodies.h"

#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/fracture.h>

#include "shapes.h"

namespace sherd {
namespace {

LabeledMesh labeled(TriangleMesh mesh) {
  LabeledMesh out;
  out.other.assign(mesh.triangles.size(), 0);
  out.mesh = std::move(mesh);
  return out;
}

const HasVoxels hasAll = [](const TriangleMesh&, const Box&, std::uint16_t) { return true; };

TriangleMesh at(TriangleMesh mesh, const glm::dvec3& by) {
  for (glm::dvec3& v : mesh.vertices) v += by;
  return mesh;
}

TEST(LooseBodies, ThatAreSmallAreRemovedWithTheirCavities) {
  const TriangleMesh small = shapes::append(shapes::cube(0.4), shapes::inverted(shapes::cube(0.2)));
  const TriangleMesh large = shapes::append(shapes::cube(2.0), shapes::inverted(shapes::cube(0.3)));
  std::vector<LabeledMesh> meshes{labeled(shapes::append(large, at(small, {3, 0, 0}))),
                                  labeled(small)};
  EXPECT_EQ(bodyCount(meshes[0].mesh), 2u);
  EXPECT_EQ(removeLooseBodies(meshes, 0.1, hasAll), 1u);
  EXPECT_EQ(bodyCount(meshes[0].mesh), 1u);
  EXPECT_EQ(meshes[0].mesh.triangles.size(), large.triangles.size());
  EXPECT_EQ(meshes[0].mesh.vertices.size(), large.vertices.size());
  EXPECT_DOUBLE_EQ(volume(meshes[0].mesh), volume(large));
  EXPECT_EQ(meshes[1].mesh.triangles.size(), small.triangles.size());  // the largest of its own
}

TEST(LooseBodies, OfCracksOrOfSomeSizeStay) {
  const TriangleMesh both = shapes::append(shapes::cube(2.0), at(shapes::cube(0.4), {3, 0, 0}));
  std::vector<LabeledMesh> meshes{labeled(both)};
  EXPECT_EQ(removeLooseBodies(meshes, 0.05, hasAll), 0u);
  meshes[0].other.back() = 2;
  EXPECT_EQ(removeLooseBodies(meshes, 0.1, hasAll), 0u);
  EXPECT_EQ(bodyCount(meshes[0].mesh), 2u);
}

TEST(LooseBodies, WithoutVoxelsAreRemovedIfTheyAreLittleLarger) {
  const TriangleMesh both = shapes::append(shapes::cube(2.0), at(shapes::cube(0.4), {3, 0, 0}));
  for (const bool hasVoxels : {true, false}) {
    std::vector<LabeledMesh> meshes{labeled(shapes::cube(2.0)), labeled(both)};
    const auto found = [&](const TriangleMesh& body, const Box& box, std::uint16_t id) {
      EXPECT_EQ(body.triangles.size(), 12u);
      EXPECT_DOUBLE_EQ(box.min.x, 2.8);
      EXPECT_EQ(id, 2);
      return hasVoxels;
    };
    EXPECT_EQ(removeLooseBodies(meshes, 0.05, found), hasVoxels ? 0u : 1u);
    EXPECT_EQ(removeLooseBodies(meshes, 0.001, found), 0u);
  }
}

TEST(LooseBodies, ThatTouchAtAVertexAreRemoved) {
  const TriangleMesh touching = at(shapes::cube(0.4), {1.2, 1.2, 1.2});
  std::vector<LabeledMesh> meshes{labeled(shapes::append(shapes::cube(2.0), touching))};
  EXPECT_EQ(removeLooseBodies(meshes, 0.1, hasAll), 1u);
  EXPECT_EQ(meshes[0].mesh.triangles.size(), 12u);
}

// A crumb of some voxels beside a cube is a small component of the solid, and one without voxels
// is none.
TEST(LooseBodies, AreLeftOutOfExactFragments) {
  const TriangleMesh crumbs =
      shapes::append(at(shapes::cube(0.1), {1.5, 0, 0}), at(shapes::cube(1e-3), {1.5, 0.71, 0.63}));
  const TriangleMesh mesh = shapes::append(shapes::cube(2.0), crumbs);
  Device device("builtin");
  FractureOptions options;
  options.pieces = 4;
  options.solid.resolution = 48;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  const FractureResult result = fracture(mesh, options, device);
  ASSERT_EQ(result.exactFailure, "");
  EXPECT_EQ(result.solid.smallComponents, 1u);
  EXPECT_EQ(result.united.loose, 1u);
  double sum = 0.0;
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(bodyCount(fragment.mesh), 1u);
    sum += volume(fragment.mesh);
  }
  EXPECT_NEAR(sum, 8.0, 1e-9);
}

}  // namespace
}  // namespace sherd
