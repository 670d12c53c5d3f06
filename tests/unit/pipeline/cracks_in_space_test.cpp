// Cracks are functions of space: solids of one mesh at several resolutions break alike.
#include <gtest/gtest.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <string>
#include <vector>

#include "kernels/device_fixture.h"
#include "pipeline/fracture_stages.h"
#include "seed/draw/voxel_index.h"
#include "seed/impacts.h"
#include "shapes.h"
#include "voxelize/canonical_solid.h"

namespace sherd {
namespace {

using CracksInSpace = DeviceTest;

PreparedSolid solidOf(const TriangleMesh& mesh, int resolution, Device& device) {
  return prepared(voxelize(mesh, {.resolution = resolution}), device);
}

// The splits of a fracture by the ids that they add, each with its signed distance, in the mesh's
// unit, from the middle of the box.
struct Crack {
  Split split;
  double distance = 0.0;
};

std::map<std::uint16_t, Crack> cracksOf(const PreparedSolid& on, const FractureOptions& options,
                                        Device& device) {
  const GrownFracture grown = grow(on, options, device, {}, nullptr);
  const double size = on.solid.frame.voxelSize;
  const glm::dvec3 middle = 64.0 * on.solid.frame.indexFromWorld(glm::dvec3(0.0));
  std::map<std::uint16_t, Crack> cracks;
  for (const Split& split : grown.result.labels.splits) {
    const auto offset = static_cast<double>(split.offset);
    const glm::dvec3 normal(split.normal);
    const double steps = split.isSphere
                             ? glm::length(middle - glm::dvec3(split.center)) - std::sqrt(offset)
                             : (glm::dot(normal, middle) - offset) / glm::length(normal);
    cracks[split.added] = {split, steps / 64.0 * size};
  }
  return cracks;
}

// Expects the same tree of the same planes and spheres, whose positions are rounded to 1/64 voxel.
void expectSameCracks(const TriangleMesh& mesh, const FractureOptions& options, Device& device,
                      const std::string& name) {
  const PreparedSolid coarse = solidOf(mesh, 60, device), fine = solidOf(mesh, 131, device);
  const auto a = cracksOf(coarse, options, device), b = cracksOf(fine, options, device);
  ASSERT_EQ(a.size(), b.size()) << name;
  const double rounding = 4.0 / 64.0 * coarse.solid.frame.voxelSize;
  for (const auto& [added, crack] : a) {
    const auto other = b.find(added);
    ASSERT_NE(other, b.end()) << name;
    EXPECT_EQ(crack.split.fragment, other->second.split.fragment) << name;
    EXPECT_EQ(crack.split.normal, other->second.split.normal) << name;
    EXPECT_EQ(crack.split.isSphere, other->second.split.isSphere) << name;
    EXPECT_NEAR(crack.distance, other->second.distance, rounding) << name;
  }
}

FractureOptions splitOptions(int pieces) {
  FractureOptions options{.pieces = pieces, .seed = 5};
  options.grow.growth = Growth::sequential;
  return options;
}

TEST_F(CracksInSpace, SplitsAreTheSameAtAnyResolution) {
  expectSameCracks(shapes::ball(1.0, 4), splitOptions(9), device(), "ball");
  expectSameCracks(shapes::torus(1.0, 0.4), splitOptions(9), device(), "torus");
  expectSameCracks(shapes::cup(1.0, 0.15, 1.6, 0.15), splitOptions(9), device(), "cup");
  const TriangleMesh two =
      shapes::append(shapes::ball(0.5, 4), shapes::ball(0.8, 4, {1.9, 0.2, 0.0}));
  expectSameCracks(two, splitOptions(9), device(), "two balls");
}

TEST_F(CracksInSpace, SizesThatAreDrawnAreTheSame) {
  FractureOptions options = splitOptions(9);
  options.shares.sizes = Sizes::lognormal;
  options.shares.sizeParameter = 0.8;
  expectSameCracks(shapes::torus(1.0, 0.4), options, device(), "lognormal");
  options.shares = {.minShare = 0.03};
  expectSameCracks(shapes::torus(1.0, 0.4), options, device(), "least share");
}

TEST_F(CracksInSpace, ImpactsAreTheSame) {
  FractureOptions options = splitOptions(20);
  options.seeds.impacts = {{.target = glm::dvec3{0.1, 0.2, 0.03}, .energy = 1.0}};
  expectSameCracks(shapes::box({2.0, 1.7, 0.06}), options, device(), "plate");
  options.seeds.impacts = {{.target = glm::dvec3{0.0, 0.0, 1.0}, .count = 8}};
  expectSameCracks(shapes::ball(1.0, 4), options, device(), "ball");
}

TEST_F(CracksInSpace, GuidesAreTheSame) {
  FractureOptions options = splitOptions(6);
  options.guides = {{.mesh = shapes::transformed(shapes::cube(1.0), 1.0, {0.7, 0.7, 0.7})}};
  const PreparedSolid coarse = solidOf(shapes::ball(1.0, 4), 60, device()),
                      fine = solidOf(shapes::ball(1.0, 4), 131, device());
  const auto sizes = [&](const PreparedSolid& on) {
    const GrownFracture grown = grow(on, options, device(), {}, nullptr);
    EXPECT_TRUE(grown.result.guideWarnings.empty());
    std::vector<double> shares;
    const std::vector<std::uint64_t> voxels = countVoxels(grown.result.labels);
    for (std::size_t id = 1; id < voxels.size(); ++id) {
      shares.push_back(static_cast<double>(voxels[id]) / static_cast<double>(on.solid.voxels));
    }
    return shares;
  };
  const std::vector<double> a = sizes(coarse), b = sizes(fine);
  ASSERT_EQ(a.size(), 6u);
  ASSERT_EQ(b.size(), 6u);
  // A crack and the ball's surface lie half a voxel off, and a piece has some 5 of area.
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i], b[i], 5.0 * 0.5 * coarse.solid.frame.voxelSize / shapes::ballVolume(1.0));
  }
}

// Returns the points of an impact's rings, world units.
std::vector<glm::dvec3> ringsOf(const PreparedSolid& on, const SeedOptions& options) {
  const std::vector<std::uint64_t> mask = surfaceMask(*on.solid.blocks);
  const VoxelIndex inside(*on.solid.blocks, on.solid.blocks->inside),
      surface(*on.solid.blocks, mask);
  const auto aimed = aim(on.solid, on.components, options, 40, inside, surface);
  std::vector<glm::dvec3> points;
  for (const glm::dvec3& point : aimed.front().rings) {
    points.push_back(on.solid.frame.worldFromIndex(point));
  }
  EXPECT_EQ(aimed.front().count, points.size());
  return points;
}

// Rings end where the wall does, so their number is the mesh's.
TEST_F(CracksInSpace, RingsHaveTheSamePoints) {
  const TriangleMesh plate = shapes::box({2.0, 1.7, 0.06}), cup = shapes::cup(1.0, 0.1, 1.6, 0.1);
  const double height = 0.3 * bounds(cup).min.z + 0.7 * bounds(cup).max.z;
  const std::vector<std::pair<const TriangleMesh*, glm::dvec3>> all{
      {&plate, {0.1, 0.2, 0.03}}, {&plate, {0.8, 0.2, 0.03}}, {&cup, {0.6, 0.8, height}}};
  for (const auto& [mesh, target] : all) {
    const SeedOptions options{.pieces = 40, .impacts = {{.target = target, .energy = 1.0}}};
    const auto a = ringsOf(solidOf(*mesh, 60, device()), options),
               b = ringsOf(solidOf(*mesh, 131, device()), options);
    EXPECT_FALSE(a.empty());
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT(glm::length(a[i] - b[i]), 1e-6) << i;
  }
}

// A wall that coarse voxels lose at one end: the seeds there move, those after them stay.
TEST_F(CracksInSpace, RingsKeepTheNumbersOfTheirSeeds) {
  TriangleMesh wedge = shapes::box({2.0, 1.7, 0.2});
  for (glm::dvec3& v : wedge.vertices) v.z *= v.x > 0.0 ? 0.05 : 1.0;
  const PreparedSolid coarse = solidOf(wedge, 40, device()), fine = solidOf(wedge, 201, device());
  const SeedOptions options{.pieces = 33,
                            .seed = 4,
                            .on = SeedsOn::volume,
                            .impacts = {{.target = glm::dvec3{0.5, 0.1, 0.04}, .energy = 1.0}}};
  const std::vector<Seed> a = placeSeeds(coarse.solid, coarse.components, options),
                          b = placeSeeds(fine.solid, fine.components, options);
  ASSERT_EQ(a.size(), b.size());
  std::size_t moved = 0, far = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double away = glm::length(coarse.solid.frame.worldFromIndex(pointOf(a[i])) -
                                    fine.solid.frame.worldFromIndex(pointOf(b[i])));
    far += away > (8.0 + std::sqrt(3.0)) * coarse.solid.frame.voxelSize ? 1 : 0;
    moved += away > (2.0 + std::sqrt(3.0)) * coarse.solid.frame.voxelSize ? 1 : 0;
  }
  EXPECT_GT(moved, 0u);
  EXPECT_LE(far, 1u);  // the seed that is of no ring is drawn anew
}

TEST_F(CracksInSpace, FracturesGrownTogetherEqualSeparateOnes) {
  const TriangleMesh mesh = shapes::torus(1.0, 0.4);
  const PreparedSolid on = solidOf(mesh, 60, device());
  std::vector<FractureOptions> options;
  for (const int pieces : {5, 4000, 12}) options.push_back(splitOptions(pieces));
  const std::vector<GrownFracture> together = growTogether(on, options, device(), {}, nullptr);
  for (std::size_t i = 0; i < options.size(); ++i) {
    const GrownFracture alone =
        grow(solidOf(mesh, 60, device()), options[i], device(), {}, nullptr);
    EXPECT_EQ(together[i].result.labels.fragment, alone.result.labels.fragment);
    EXPECT_EQ(alone.result.labels.fragmentCount, options[i].pieces);
  }
}

TEST(CanonicalSolids, AreTheSameOfAllResolutions) {
  const TriangleMesh mesh = shapes::cup(1.0, 0.15, 1.6, 0.15);
  const auto coarse = canonicalOf(voxelize(mesh, {.resolution = 40}), nullptr),
             fine = canonicalOf(voxelize(mesh, {.voxelSize = 0.0117}), nullptr);
  ASSERT_TRUE(coarse && fine);
  EXPECT_EQ(coarse->frame.voxelSize, 2.0 / CanonicalSolid::kResolution);
  EXPECT_EQ(coarse->blocks->origins, fine->blocks->origins);
  EXPECT_EQ(coarse->blocks->inside, fine->blocks->inside);
  const Solid same = voxelize(mesh, {.resolution = CanonicalSolid::kResolution});
  EXPECT_FALSE(canonicalOf(same, nullptr));
  EXPECT_EQ(coarse->blocks->inside, same.blocks->inside);
}

TEST(CanonicalSolids, ResolveThinWalls) {
  const auto canonical = [](double thickness, int resolution) {
    const TriangleMesh mesh = shapes::box({2.0, 1.7, thickness});
    return canonicalOf(voxelize(mesh, {.resolution = resolution}), nullptr);
  };
  const auto thin = canonical(0.017, 250), thinnest = canonical(0.013, 250);
  ASSERT_TRUE(thin && thinnest);
  EXPECT_LE(kWholeWallVoxels * thin->frame.voxelSize, 0.017);
  EXPECT_EQ(thinnest->frame.voxelSize, 2.0 / CanonicalSolid::kMostResolution);
}

// Returns the centers of the voxels of fragments, in lengths of the mesh's longest side.
std::vector<glm::dvec3> centersOf(const FractureResult& result, double side) {
  std::vector<glm::dvec3> sums(static_cast<std::size_t>(result.labels.fragmentCount));
  std::vector<double> counts(sums.size(), 0.0);
  result.labels.blocks->forEachInside([&](std::size_t voxel) {
    const std::size_t at = result.labels.fragment[voxel] - std::size_t{1};
    const openvdb::Coord c = result.labels.blocks->voxelAt(voxel);
    sums[at] += glm::dvec3(result.solid.frame.worldFromIndex(c));
    counts[at] += 1.0;
  });
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= counts[i] * side;
  return sums;
}

// Expects them within a hundredth, and half a voxel of the coarser solid.
void expectSameCenters(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b,
                       int resolution, const std::string& name) {
  ASSERT_EQ(a.size(), b.size()) << name;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_LT(glm::distance(a[i], b[i]), 0.01 + 0.5 / resolution) << name << " " << i;
  }
}

// Returns a fracture whose second fragment is broken again.
//   hasMeshes  whether the fragments' meshes are known
FractureResult brokenAgain(const TriangleMesh& mesh, int resolution, FractureOptions options,
                           bool hasMeshes, Device& device) {
  FractureOptions first{.pieces = 4, .seed = 3, .solid = {.resolution = resolution}};
  first.surface.surface = Surface::exact;
  SourceMesh source;
  source.mesh = mesh;
  FinishedFracture finished =
      finishedFracture(source, first, fracture(mesh, first, device), WriteOptions{});
  if (!hasMeshes) finished.faces = {}, finished.firstFace = {}, finished.isExact = false;
  options.surface.meshes = false;
  options.surface.levelSets = false;
  const std::array<int, 1> only{2};
  return refracture(finished, only, options, device);
}

TEST_F(CracksInSpace, FragmentsBreakAgainAlikeAtAnyResolution) {
  const TriangleMesh bar = shapes::box({4.0, 0.4, 0.4});
  for (const Growth growth : {Growth::euclid, Growth::sequential}) {
    FractureOptions options{.pieces = 4, .seed = 7};
    options.grow.growth = growth;
    const TriangleMesh mesh =
        growth == Growth::euclid ? shapes::ball(1.0, 2) : shapes::cup(1.0, 0.25, 1.6, 0.25, 24);
    expectSameCenters(centersOf(brokenAgain(mesh, 41, options, true, device()), 2.0),
                      centersOf(brokenAgain(mesh, 86, options, true, device()), 2.0), 41, "meshes");
    expectSameCenters(centersOf(brokenAgain(bar, 301, options, false, device()), 4.0),
                      centersOf(brokenAgain(bar, 390, options, false, device()), 4.0), 301,
                      "voxels alone");
  }
}

// As level sets are that are read.
TEST_F(CracksInSpace, SolidsWithoutMeshesSplitAlikeWhereTheyAreFiner) {
  const TriangleMesh bar = shapes::box({2.0, 0.5, 0.3});
  std::vector<std::vector<glm::dvec3>> centers;
  for (const int resolution : {131, 187}) {
    Solid solid = voxelize(bar, {.resolution = resolution});
    solid.region = nullptr;
    FractureOptions options = splitOptions(6);
    options.surface.meshes = options.surface.levelSets = false;
    centers.push_back(centersOf(fracture(std::move(solid), options, device()), 2.0));
  }
  expectSameCenters(centers[0], centers[1], 131, "bar");
}

}  // namespace
}  // namespace sherd
