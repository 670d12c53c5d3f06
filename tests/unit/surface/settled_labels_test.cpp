// Labels that follow exact meshes where voxels connect what the mesh parts.
#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>
#include <sherd/solid.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <numbers>
#include <set>
#include <vector>

#include "mesh/search/triangle_tree.h"
#include "shapes.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

TriangleMesh barFrom(const glm::dvec3& low, const glm::dvec3& high) {
  TriangleMesh bar = shapes::box(high - low);
  for (glm::dvec3& v : bar.vertices) v += (low + high) / 2.0;
  return bar;
}

// A fork with two prongs, 4 high; the slot between them is 0.4 voxels wide at 40 voxels a side.
TriangleMesh fork() {
  const double half = 0.02;
  const TriangleMesh handle = barFrom({-1.0, 0.0, -0.5}, {1.0, 1.0, 0.5});
  return shapes::append(shapes::append(handle, barFrom({-1.0, 0.5, -0.5}, {-half, 4.0, 0.5})),
                        barFrom({half, 0.5, -0.5}, {1.0, 4.0, 0.5}));
}

// A prism about z, over a regular polygon.
TriangleMesh prism(double radius, double low, double high, std::uint32_t sides) {
  TriangleMesh mesh;
  mesh.vertices = {{0.0, 0.0, low}, {0.0, 0.0, high}};
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    const glm::dvec3 at(radius * std::cos(angle), radius * std::sin(angle), low);
    mesh.vertices.insert(mesh.vertices.end(), {at, {at.x, at.y, high}});
    const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % sides);
    for (const auto& triangle : {std::array{a, b, b + 1}, std::array{a, b + 1, a + 1},
                                 std::array{0u, b, a}, std::array{1u, a + 1, b + 1}}) {
      mesh.triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
    }
  }
  return mesh;
}

// One fragment is the handle with half of the prongs; the voxels of the other's prongs touch.
FractureResult brokenFork(Device& device) {
  FractureOptions options;
  options.solid.resolution = 40;
  options.seeds.given = GivenSeeds{"", {{{-0.5, 1.0, 0.0}, 1}, {{-0.5, 3.0, 0.0}, 2}}};
  options.surface = {.levelSets = false, .surface = Surface::exact};
  return fracture(fork(), options, device);
}

// Expects nearly all voxels' centers within the meshes of their fragments, of one body each.
void expectAgree(const FractureResult& result) {
  ASSERT_EQ(result.exactFailure, "");
  const LeafBlocks& blocks = *result.labels.blocks;
  std::vector<TriangleTree> trees;
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(meshComponents(fragment.mesh).count, 1u);
    trees.emplace_back(fragment.mesh);
  }
  std::vector<std::size_t> all(trees.size()), within(trees.size());
  blocks.forEachInside([&](std::size_t voxel) {
    const std::size_t own = result.labels.fragment[voxel] - 1u;
    const openvdb::Coord at = blocks.voxelAt(voxel);
    const glm::dvec3 center = result.solid.frame.worldFromIndex(glm::dvec3(at.x(), at.y(), at.z()));
    ++all[own];
    within[own] += trees[own].winding(center) >= 0.5;
  });
  for (std::size_t i = 0; i < trees.size(); ++i) {
    EXPECT_EQ(all[i], result.fragments[i].voxels);
    EXPECT_GT(within[i], 0.95 * static_cast<double>(all[i])) << "fragment " << i + 1;
  }
}

// Expects labels and meshes of each fragment of about one volume: their ratio within bounds.
void expectVolumes(const FractureResult& result, double low, double high, std::uint64_t seed) {
  ASSERT_EQ(result.exactFailure, "");
  for (const Fragment& fragment : result.fragments) {
    const double ofVoxels =
        static_cast<double>(fragment.voxels) * std::pow(result.solid.frame.voxelSize, 3);
    EXPECT_GT(fragment.mass.volume, low * ofVoxels) << seed << ", " << fragment.id;
    EXPECT_LT(fragment.mass.volume, high * ofVoxels) << seed << ", " << fragment.id;
  }
}

TEST(SettledLabels, GoWithTheBodiesThatAFragmentLoses) {
  Device device("builtin");
  const FractureResult result = brokenFork(device);
  ASSERT_EQ(result.fragments.size(), 2u);
  expectAgree(result);
  // The end of one prong went to the handle.
  EXPECT_NEAR(result.fragments[1].mass.volume, 0.98 * 2.0, 0.05);
}

// Ten teeth with slots of half a voxel: many fragments lose a tooth or get one.
TEST(SettledLabels, OfACombGoToothByTooth) {
  Device device("builtin");
  TriangleMesh comb = barFrom({0.0, 0.0, 0.0}, {10.0, 1.0, 1.0});
  for (int tooth = 0; tooth < 10; ++tooth)
    comb = shapes::append(comb, barFrom({tooth + 0.05, 0.5, 0.0}, {tooth + 0.95, 5.0, 1.0}));
  for (const std::uint64_t seed : {0u, 1u, 2u}) {
    FractureOptions options;
    options.pieces = 8;
    options.seed = seed;
    options.solid.resolution = 50;
    options.surface = {.levelSets = false, .surface = Surface::exact};
    expectVolumes(fracture(comb, options, device), 0.75, 1.1, seed);
  }
}

// Plates that nearly touch, with a pin through all: what a fragment loses is a part of a plate,
// with single voxels across the gap that no other fragment touches but by the band outside.
TEST(SettledLabels, OfAStackGoPlateByPlate) {
  Device device("builtin");
  for (const std::uint64_t seed : {0u, 1u, 2u, 3u}) {
    TriangleMesh stack = prism(0.05, -0.1, 0.9, 16);
    for (std::uint32_t plate = 0; plate < 4; ++plate) {
      const double low = 0.1807 * plate;
      stack = shapes::append(stack, prism(1.0 - 0.1 * plate, low, low + 0.18, 40u + 2u * plate));
    }
    FractureOptions options;
    options.pieces = 10;
    options.seed = seed;
    options.solid.resolution = 64;
    options.surface = {.levelSets = false, .surface = Surface::exact};
    expectVolumes(fracture(stack, options, device), 0.8, 1.25, seed);
  }
}

TEST(SettledLabels, KeepTheLeastShare) {
  Device device("builtin");
  FractureOptions options;
  options.pieces = 2;
  options.solid.resolution = 40;
  options.shares.minShare = 0.42;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    options.seed = seed;
    const FractureResult result = fracture(fork(), options, device);
    for (const Fragment& fragment : result.fragments) {
      EXPECT_GE(static_cast<double>(fragment.voxels),
                0.42 * static_cast<double>(result.solid.voxels));
    }
  }
}

TEST(SettledLabels, AreThoseOfFragmentsThatAreBrokenAgain) {
  Device device("builtin");
  FractureOptions whole;
  whole.pieces = 1;
  whole.solid.resolution = 40;
  whole.surface.surface = Surface::exact;
  SourceMesh source;
  source.mesh = fork();
  source.name = "fork";
  const FractureResult first = fracture(source.mesh, whole, device);
  ASSERT_EQ(first.exactFailure, "");
  FractureOptions again = whole;
  again.pieces = 2;
  again.seeds.given = GivenSeeds{"", {{{-0.5, 1.0, 0.0}, 1}, {{-0.5, 3.0, 0.0}, 2}}};
  const FinishedFracture finished = finishedFracture(source, whole, first, {});
  const FractureResult result = refracture(finished, std::vector{1}, again, device);
  ASSERT_EQ(result.fragments.size(), 2u);
  expectAgree(result);
}

}  // namespace
}  // namespace sherd
