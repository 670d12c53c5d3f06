// Bodies that stay apart however near they are: as voxels, in growth, erosion and exact surfaces.
#include <gtest/gtest.h>
#include <sherd/fracture.h>
#include <sherd/labels.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <map>
#include <memory>
#include <numbers>
#include <set>
#include <vector>

#include "kernels/device_fixture.h"
#include "mesh/search/triangle_tree.h"
#include "shapes.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

using BodyLayers = DeviceTest;
using Bodies = std::vector<TriangleMesh>;

// Turns bodies about an axis through the origin that is parallel to no other.
Bodies turnedBodies(Bodies bodies) {
  const glm::dmat3 turn = glm::mat3_cast(glm::normalize(glm::dquat(0.9, 0.1, 0.3, 0.2)));
  for (TriangleMesh& body : bodies) {
    for (glm::dvec3& v : body.vertices) v = turn * v;
  }
  return bodies;
}

// Bricks without mortar: gaps of `gap` between all of them.
Bodies bricks(double gap) {
  Bodies all;
  for (int x = 0; x < 3; ++x) {
    for (int z = 0; z < 2; ++z) {
      const double pitch = 6.0 + gap;
      all.push_back(shapes::cube(6.0, {pitch * x + 1.7 * z, 0.3, pitch * z}));
    }
  }
  return all;
}

Bodies cards(double thickness, double gap, int count = 8) {
  Bodies all;
  for (int i = 0; i < count; ++i) {
    all.push_back(shapes::transformed(shapes::box({24.0, 24.0, thickness}), 1.0,
                                      {0.0, 0.0, (thickness + gap) * i}));
  }
  return all;
}

std::vector<Bodies> nearBodies() {
  std::vector<Bodies> all;
  for (const double gap : {1e-9, 0.1, 0.5, 0.9, 1.5, 2.5}) {
    all.push_back(bricks(gap));
    all.push_back(turnedBodies(bricks(gap)));
  }
  all.push_back(cards(0.95, 0.05));
  all.push_back(turnedBodies(cards(1.4, 0.02)));
  all.push_back({shapes::ball(8.0, 3), shapes::ball(8.0, 3, {16.02, 0.0, 0.0})});
  all.push_back({shapes::hollowBall(10.0, 7.0), shapes::ball(6.8)});
  return all;
}

// [voxels] the body that contains the center of each inside voxel, or -1.
std::vector<int> bodiesOfVoxels(const Solid& solid, const Bodies& bodies) {
  std::vector<int> body(solid.blocks->count() * 512, -1);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const TriangleTree tree(bodies[i]);
    solid.blocks->forEachInside([&](std::size_t voxel) {
      const glm::dvec3 at = solid.frame.worldFromIndex(solid.blocks->voxelAt(voxel));
      if (tree.winding(at) >= 0.5) body[voxel] = static_cast<int>(i);
    });
  }
  return body;
}

TEST_F(BodyLayers, VoxelsAreConnectedWithinTheirBodiesOnly) {
  for (const Bodies& bodies : nearBodies()) {
    const Solid solid = voxelize(shapes::joined(bodies), {.voxelSize = 1.0});
    const std::vector<int> body = bodiesOfVoxels(solid, bodies);
    const VoxelComponents components = findComponents(*solid.blocks, device());
    std::map<std::uint32_t, std::set<int>> bodiesOfComponents;
    std::set<int> found;
    solid.blocks->forEachInside([&](std::size_t voxel) {
      if (body[voxel] < 0) return;  // a bridge
      bodiesOfComponents[components.at(voxel)].insert(body[voxel]);
      found.insert(body[voxel]);
    });
    for (const auto& [component, own] : bodiesOfComponents) EXPECT_EQ(own.size(), 1u);
    EXPECT_EQ(found.size(), bodies.size());
  }
}

TEST_F(BodyLayers, ThickBodiesAreOneComponentEach) {
  for (const double gap : {1e-9, 0.1, 0.5, 0.9, 1.5, 2.5}) {
    for (const Bodies& bodies : {bricks(gap), turnedBodies(bricks(gap))}) {
      const Solid solid = voxelize(shapes::joined(bodies), {.voxelSize = 1.0});
      EXPECT_EQ(findComponents(*solid.blocks, device()).count(), bodies.size()) << gap;
      EXPECT_NEAR(static_cast<double>(solid.voxels), 6.0 * 216.0, 130.0);
      if (gap < 0.4) {
        EXPECT_EQ(solid.report.nearBodies, bodies.size());
      }
    }
  }
}

// Cubes of a side, with gaps of 0.1 between them.
TriangleMesh lattice(double side, int count) {
  TriangleMesh all;
  for (int i = 0; i < count * count * count; ++i) {
    const glm::dvec3 cell(i % count, i / count % count, i / count / count);
    const TriangleMesh cube = shapes::cube(side, cell * (side + 0.1));
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), cube.vertices.begin(), cube.vertices.end());
    for (const glm::uvec3& t : cube.triangles) all.triangles.push_back(t + first);
  }
  return all;
}

TEST_F(BodyLayers, AThousandBodiesStayApart) {
  const Solid solid = voxelize(lattice(3.4, 10), {.voxelSize = 1.0});
  EXPECT_EQ(findComponents(*solid.blocks, device()).count(), 1000u);
  EXPECT_EQ(solid.report.nearBodies, 1000u);
  EXPECT_LE(solid.blocks->layers.size(), 26u);  // a body has at most 26 neighbors
}

TEST_F(BodyLayers, TooManyAreJoined) {
  const Solid solid = voxelize(lattice(1.0, 10), {.voxelSize = 1.0});
  EXPECT_TRUE(solid.report.hasJoinedBodies);
  EXPECT_TRUE(solid.blocks->layers.empty());
  EXPECT_FALSE(voxelize(lattice(3.4, 3), {.voxelSize = 1.0}).report.hasJoinedBodies);
}

TEST_F(BodyLayers, BodiesThatTouchOverlapOrLieWithinEachOtherAreOne) {
  Bodies deep{shapes::cube(24.0)};  // those within are near each other, not near the outside
  deep.push_back(shapes::cube(4.0, {-2.1, 0.0, 0.0}));
  deep.push_back(shapes::cube(4.0, {2.1, 0.0, 0.0}));
  for (const Bodies& bodies : {bricks(0.0), bricks(-0.3), turnedBodies(bricks(-0.3)), deep,
                               Bodies{shapes::cube(12.0), shapes::cube(4.0, {3.7, 0.1, 0.2})},
                               Bodies{shapes::hollowBall(10.0, 8.6)}}) {
    const Solid solid = voxelize(shapes::joined(bodies), {.voxelSize = 1.0});
    EXPECT_EQ(findComponents(*solid.blocks, device()).count(), 1u);
    EXPECT_EQ(solid.report.nearBodies, 0u);
    EXPECT_TRUE(solid.blocks->layers.empty());
  }
}

// Where no voxels of different bodies lie side by side, layers change nothing.
TEST_F(BodyLayers, GrowthIsThatOfOneLayerWhereBodiesAreFarEnoughApart) {
  const Solid layered = voxelize(shapes::joined(bricks(1.2)), {.voxelSize = 0.5});
  ASSERT_GT(layered.blocks->layers.size(), 0u);
  Solid plain = layered;
  LeafBlocks blocks = *layered.blocks;
  blocks.layers.clear();
  plain.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  for (const Growth growth : {Growth::flood, Growth::chain, Growth::sequential}) {
    for (const double roughness : {0.0, 0.7}) {
      for (const int neighborhood : {6, 26}) {
        if (neighborhood == 26 && growth != Growth::flood) continue;
        FractureOptions options{.pieces = 23, .seed = 4};
        options.grow = {.growth = growth, .neighborhood = neighborhood, .roughness = roughness};
        options.grow.keepCost = growth != Growth::sequential;
        const FractureResult a = fracture(plain, options, device());
        const FractureResult b = fracture(layered, options, device());
        EXPECT_EQ(a.seeds, b.seeds);
        EXPECT_EQ(a.labels.fragment, b.labels.fragment) << static_cast<int>(growth) << roughness;
        EXPECT_EQ(a.labels.cost, b.labels.cost);
        EXPECT_EQ(a.labels.disconnected, b.labels.disconnected);
      }
    }
  }
}

// Where each body has a layer: seeds of another are beyond a gap, however near they are.
TEST_F(BodyLayers, CellsAreThoseOfTheSeedsInTheirBody) {
  Bodies bodies{shapes::cube(14.0), shapes::cube(14.0, {14.05, 0.0, 0.0}),
                shapes::cube(14.0, {7.0, 0.0, 14.05})};
  for (const bool isTurned : {false, true}) {
    if (isTurned) bodies = turnedBodies(bodies);
    const Solid solid = voxelize(shapes::joined(bodies), {.voxelSize = 1.0});
    ASSERT_EQ(solid.blocks->layers.size(), 2u);
    const std::vector<int> body = bodiesOfVoxels(solid, bodies);
    for (const Growth growth : {Growth::euclid, Growth::nearest}) {
      FractureOptions options{.pieces = 18, .seed = 3};
      options.grow.growth = growth;
      const FractureResult result = fracture(solid, options, device());
      std::uint64_t others = 0;
      std::map<openvdb::Coord, std::size_t> voxelAt;
      solid.blocks->forEachInside(
          [&](std::size_t voxel) { voxelAt[solid.blocks->voxelAt(voxel)] = voxel; });
      for (const auto& [at, voxel] : voxelAt) {
        double least = 1e9, own = 1e9;
        for (const Seed& seed : result.seeds) {
          if (body[voxelAt.at(seed.voxel)] != body[voxel]) continue;
          const double distance = glm::distance(pointOf(seed), glm::dvec3(at.x(), at.y(), at.z()));
          least = std::min(least, distance);
          if (seed.fragment == result.labels.fragment[voxel]) own = std::min(own, distance);
        }
        others += own > least + 1e-9 ? 1 : 0;
      }
      // Those of the other side of an edge of the body, which their cells do not reach by faces.
      EXPECT_LT(others, isTurned ? solid.voxels / 1000 : 1);
    }
  }
}

TEST_F(BodyLayers, AFragmentIsOfOneBody) {
  for (const Bodies& bodies :
       {bricks(0.01), turnedBodies(bricks(0.3)), turnedBodies(cards(3.0, 0.02))}) {
    Solid solid = voxelize(shapes::joined(bodies), {.voxelSize = 1.0});
    const std::vector<int> body = bodiesOfVoxels(solid, bodies);
    for (const Growth growth : {Growth::flood, Growth::chain, Growth::euclid, Growth::sequential}) {
      FractureOptions options{.pieces = 20, .seed = 2};
      options.grow = {.growth = growth, .roughness = 0.6};
      const FractureResult result = fracture(solid, options, device());
      std::vector<std::set<int>> bodiesOf(21);
      result.labels.blocks->forEachInside([&](std::size_t voxel) {
        if (body[voxel] >= 0) bodiesOf[result.labels.fragment[voxel]].insert(body[voxel]);
      });
      EXPECT_TRUE(bodiesOf[0].empty());
      for (std::size_t id = 1; id < bodiesOf.size(); ++id) EXPECT_EQ(bodiesOf[id].size(), 1u) << id;
    }
  }
}

TEST_F(BodyLayers, FragmentsBreakAgainByThemselves) {
  const FractureResult first =
      fracture(voxelize(shapes::joined(bricks(0.01)), {.voxelSize = 0.5}), {.pieces = 6}, device());
  FinishedFracture finished;
  finished.solid = first.solid;
  finished.labels = first.labels;
  const std::vector<int> only{1, 4};
  const FractureResult again = refracture(finished, only, {.pieces = 3}, device());
  const std::vector<std::uint64_t> before = countVoxels(first.labels);
  const std::vector<std::uint64_t> after = countVoxels(again.labels);
  ASSERT_EQ(again.parents.size(), 10u);
  std::vector<std::uint64_t> ofParent(7, 0);
  for (std::size_t i = 0; i < again.parents.size(); ++i) {
    ofParent[static_cast<std::size_t>(again.parents[i])] += after[i + 1];
  }
  for (std::size_t id = 1; id < ofParent.size(); ++id) EXPECT_EQ(ofParent[id], before[id]);
}

TEST_F(BodyLayers, CracksAloneErode) {
  FractureOptions options{.pieces = 6, .solid = {.voxelSize = 1.0}};
  options.erode = {.iterations = 2.0, .on = ErodeOn::fracture};
  const FractureResult whole =
      fracture(shapes::joined(turnedBodies(bricks(0.05))), options, device());
  EXPECT_EQ(whole.eroded[0], 0u);  // each brick is a piece, without cracks
  options.pieces = 12;
  EXPECT_GT(fracture(shapes::joined(turnedBodies(bricks(0.05))), options, device()).eroded[0], 0u);
}

TEST_F(BodyLayers, CoarseFragmentsAreWhereTheirBodiesAre) {
  const Bodies bodies = bricks(0.01);
  FractureOptions options{.pieces = 12, .solid = {.voxelSize = 1.0}};
  options.surface = {.levelSets = false, .surface = Surface::exact, .triangles = {60}};
  const FractureResult result = fracture(shapes::joined(bodies), options, device());
  ASSERT_EQ(result.exactFailure, "");
  for (const Fragment& fragment : result.fragments) {
    ASSERT_EQ(fragment.coarse.size(), 1u);
    const Box fine = bounds(fragment.mesh), coarse = bounds(fragment.coarse.front());
    for (int k = 0; k < 3; ++k) {  // within the voxel that the decimation may move them by
      EXPECT_NEAR(fine.min[k], coarse.min[k], 1.0);
      EXPECT_NEAR(fine.max[k], coarse.max[k], 1.0);
    }
  }
}

TEST_F(BodyLayers, ExactFragmentsAreOfOneBody) {
  for (const Bodies& bodies : nearBodies()) {
    FractureOptions options{.pieces = 15, .solid = {.voxelSize = 1.0, .keepMesh = true}};
    options.surface.surface = Surface::exact;
    const FractureResult result = fracture(shapes::joined(bodies), options, device());
    ASSERT_EQ(result.exactFailure, "");
    std::vector<double> volumes(bodies.size(), 0.0);
    std::vector<TriangleTree> trees;
    for (const TriangleMesh& body : bodies) trees.emplace_back(body);
    for (const Fragment& fragment : result.fragments) {
      const TriangleMesh& mesh = fragment.mesh;
      std::set<std::size_t> own;  // bodies whose triangles it has
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (mesh.source[t] == TriangleMesh::kNoSource) continue;
        std::size_t body = 0, first = 0;
        while (mesh.source[t] >= first + bodies[body].triangles.size()) {
          first += bodies[body++].triangles.size();
        }
        own.insert(body);
      }
      ASSERT_EQ(own.size(), 1u);
      volumes[*own.begin()] += volume(mesh);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      EXPECT_NEAR(volumes[i], volume(bodies[i]), 1e-9 * volume(bodies[i]));
    }
  }
}

// A box of cells along x, so that the nearest of several triangles may be any.
TriangleMesh slab(double low, double high, unsigned cells = 3, double length = 3.0,
                  double width = 1.0) {
  TriangleMesh mesh;
  for (unsigned i = 0; i <= cells; ++i) {
    for (unsigned k = 0; k < 4; ++k) {
      mesh.vertices.emplace_back(length * i / cells, (k & 1) == 0 ? 0.0 : width,
                                 (k & 2) == 0 ? low : high);
    }
  }
  const auto add = [&](unsigned a, unsigned b, unsigned c, unsigned d) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(a, c, d);
  };
  for (unsigned i = 0; i < 4 * cells; i += 4) {
    add(i, i + 1, i + 5, i + 4);
    add(i + 2, i + 6, i + 7, i + 3);
    add(i, i + 4, i + 6, i + 2);
    add(i + 1, i + 3, i + 7, i + 5);
  }
  add(0, 2, 3, 1);
  add(4 * cells, 4 * cells + 1, 4 * cells + 3, 4 * cells + 2);
  return mesh;
}

// In the space of voxels the two have one plane in common.
TEST_F(BodyLayers, AGapOfTheLastBitIsOne) {
  const double middle = 0.481223718069968;
  const TriangleMesh below = slab(0.0, middle),
                     above = slab(std::nextafter(middle, 1.0), 2.0 * middle);
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    FractureOptions options{.pieces = 13, .seed = seed, .solid = {.resolution = 40}};
    options.surface = {.levelSets = false, .surface = Surface::exact};
    const FractureResult result = fracture(shapes::append(below, above), options, device());
    ASSERT_EQ(result.exactFailure, "");
    double sumBelow = 0.0;
    std::vector<bool> isBelow{false};  // [ids]
    for (const Fragment& fragment : result.fragments) {
      EXPECT_GT(fragment.mass.volume, 0.0);
      const Box box = bounds(fragment.mesh);
      isBelow.push_back(box.max.z <= middle);
      EXPECT_TRUE(isBelow.back() || box.min.z > middle);
      if (isBelow.back()) sumBelow += fragment.mass.volume;
    }
    EXPECT_NEAR(sumBelow, volume(below), 1e-9);
    result.labels.blocks->forEachInside([&](std::size_t voxel) {
      const openvdb::Coord at = result.labels.blocks->voxelAt(voxel);
      const double z = result.solid.frame.worldFromIndex(glm::dvec3(at.x(), at.y(), at.z())).z;
      EXPECT_EQ(z < middle, isBelow[result.labels.fragment[voxel]]);
    });
  }
}

// A voxel midway in a plate is as near to its other face as to the plane that it has in common.
TEST_F(BodyLayers, AThinPlateBesideAGapOfTheLastBitIsThere) {
  const double voxel = 0.9, side = 24.0 * voxel;
  const auto at = [&](double index) { return (index + 0.5) * voxel; };
  double below = at(8.25);  // the lower one of two numbers that are 8.25 voxels
  for (int i = 0; i < 4; ++i) below = std::nextafter(below, 0.0);
  while ((below - at(0.0)) / voxel < 8.25) below = std::nextafter(below, 9.0);
  const double above = std::nextafter(below, 9.0);
  ASSERT_EQ((above - at(0.0)) / voxel, 8.25);
  const auto moved = [&](TriangleMesh mesh, double by) {
    for (glm::dvec3& v : mesh.vertices) v += glm::dvec3(by, by, 0.0);
    return mesh;
  };
  const TriangleMesh corners =
      shapes::append(slab(0.0, voxel, 1, voxel, voxel),
                     moved(slab(30 * voxel, 32 * voxel, 1, 2 * voxel, 2 * voxel), 30 * voxel));
  for (const auto& [first, second] : {std::pair{3u, 3u}, {3u, 7u}, {7u, 3u}, {40u, 40u}}) {
    for (const bool isReversed : {false, true}) {
      Bodies bodies{moved(slab(at(7.75), below, first, side, side), 2 * voxel),
                    moved(slab(above, at(9.4), second, side, side), 2 * voxel)};
      if (isReversed) std::reverse(bodies.begin(), bodies.end());
      bodies.push_back(corners);
      const Solid solid = voxelize(shapes::joined(bodies), {.voxelSize = voxel});
      ASSERT_EQ(solid.frame.origin, glm::dvec3(voxel / 2.0));
      const std::vector<int> body = bodiesOfVoxels(solid, bodies);
      std::map<int, std::set<std::size_t>> layers;  // of bodies
      solid.blocks->forEachInside([&](std::size_t v) {
        if (body[v] >= 0) layers[body[v]].insert(solid.blocks->layerOf(v));
      });
      EXPECT_EQ(layers[0].size(), 1u);
      EXPECT_EQ(layers[1].size(), 1u);
      EXPECT_NE(layers[0], layers[1]);
    }
  }
}

TEST_F(BodyLayers, BodiesOfDifferentLayersAreDecimatedEachForItself) {
  const double gap = 0.2 / 40;
  const TriangleMesh mesh = shapes::append(shapes::cube(1.0), shapes::cube(1.0, {1.0 + gap, 0, 0}));
  FractureOptions options;
  options.pieces = 6;
  options.solid.resolution = 40;
  options.grow.roughness = 1.0;
  options.surface = {.levelSets = false, .surface = Surface::exact, .triangles = {200}};
  const FractureResult result = fracture(mesh, options, device());
  ASSERT_EQ(result.exactFailure, "");
  ASSERT_FALSE(result.solid.blocks->layers.empty());
  double sum = 0.0;
  for (const Fragment& fragment : result.fragments) {
    const TriangleMesh& coarse = fragment.coarse.front();
    EXPECT_EQ(openEdges(coarse), 0u);
    EXPECT_NEAR(volume(coarse), fragment.mass.volume, 0.1 * fragment.mass.volume);
    sum += volume(coarse);
  }
  EXPECT_NEAR(sum, 2.0, 0.01);  // cracks are shared; only the outside may move
}

}  // namespace
}  // namespace sherd
