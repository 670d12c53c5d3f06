// A fracture from mesh to fragments, on shapes whose volume and surface are known (its promises are
// tested in promises_test.cpp).
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <sherd/error.h>
#include <sherd/fracture.h>
#include <sherd/points.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/text/json_text.h"
#include "cut/leaf_labels.h"
#include "kernels/device_fixture.h"
#include "pipeline/fracture_stages.h"
#include "points/check_points.h"
#include "shapes.h"
#include "surface/check_finite.h"

namespace sherd {
namespace {

using Fracture = DeviceTest;

TEST_F(Fracture, OnePieceReturnsTheSolid) {
  for (const Interface interface : {Interface::shared, Interface::independent}) {
    const SurfaceOptions surface{.interface = interface};
    const FractureResult result =
        fracture(shapes::torus(1.0, 0.4),
                 {.pieces = 1, .solid = {.resolution = 64}, .surface = surface}, device());
    ASSERT_EQ(result.fragments.size(), 1u);
    const Fragment& piece = result.fragments[0];
    const TriangleMesh whole = solidMesh(result.solid);
    if (interface == Interface::shared) {
      EXPECT_TRUE(piece.mesh.triangles == whole.triangles);
      EXPECT_TRUE(piece.mesh.vertices == whole.vertices);
    }
    EXPECT_NEAR(piece.mass.volume, volume(whole), 0.002 * volume(whole));
    EXPECT_TRUE(piece.contacts.empty());
    EXPECT_EQ(piece.fractureArea, 0.0);
    const auto values = piece.surface->getConstAccessor();
    for (auto on = result.solid.distance->cbeginValueOn(); on; ++on)
      ASSERT_EQ(values.getValue(on.getCoord()), *on);
  }
}

TEST_F(Fracture, AHalvedBallHasADiscForContact) {
  // Two pieces of a ball with the seeds' ids swapped by other seeds: whatever the cut, both sides
  // have one area, and it lies between that of a small cap's disc and twice the equator's.
  const FractureResult result = fracture(
      shapes::ball(1.0, 5), {.pieces = 2, .seed = 5, .solid = {.resolution = 96}}, device());
  ASSERT_EQ(result.fragments[0].contacts.size(), 1u);
  const Contact& contact = result.fragments[0].contacts[0];
  EXPECT_NEAR(contact.area,
              (result.fragments[0].fractureArea + result.fragments[1].fractureArea) / 2,
              1e-9 * contact.area);
  // The divergence theorem: over a closed surface area times normal adds up to nothing, so the
  // fracture faces' sum is minus the original faces'.
  for (const Fragment& piece : result.fragments) {
    glm::dvec3 sum(0.0), outer(0.0);
    for (std::size_t t = 0; t < piece.mesh.neighbor.size(); ++t) {
      const glm::uvec3& c = piece.mesh.triangles[t];
      const glm::dvec3 a = piece.mesh.vertices[c.x];
      (piece.mesh.neighbor[t] ? sum : outer) +=
          glm::cross(piece.mesh.vertices[c.y] - a, piece.mesh.vertices[c.z] - a) / 2.0;
    }
    EXPECT_NEAR(glm::length(sum + outer), 0.0, 1e-9);
    EXPECT_GT(glm::dot(glm::normalize(sum), piece.contacts[0].normal), 0.99);
    EXPECT_LE(glm::length(sum), contact.area * 1.05);
  }
}

TEST_F(Fracture, MovingAndScalingTheInputMovesAndScalesTheOutput) {
  const TriangleMesh mesh = shapes::cup(1.0, 0.25, 1.5, 0.25, 64);
  const FractureOptions options{.pieces = 6, .seed = 9, .solid = {.resolution = 64}};
  // Multiples of 2^-10 in, so that moving and scaling by powers of two is exact.
  TriangleMesh exact = mesh;
  for (glm::dvec3& v : exact.vertices) v = glm::round(v * 1024.0) / 1024.0;
  const FractureResult one = fracture(exact, options, device());
  const FractureResult moved =
      fracture(shapes::transformed(exact, 4.0, {64.0, -32.0, 8.0}), options, device());
  EXPECT_EQ(one.labels.fragment, moved.labels.fragment);
  ASSERT_EQ(one.fragments.size(), moved.fragments.size());
  for (std::size_t i = 0; i < one.fragments.size(); ++i) {
    const TriangleMesh& a = one.fragments[i].mesh;
    const TriangleMesh& b = moved.fragments[i].mesh;
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    EXPECT_TRUE(a.triangles == b.triangles);
    ASSERT_EQ(one.fragments[i].mesh.neighbor, moved.fragments[i].mesh.neighbor);
    double worst = 0.0;
    for (std::size_t v = 0; v < a.vertices.size(); ++v) {
      worst = std::max(
          worst, glm::length(a.vertices[v] * 4.0 + glm::dvec3(64.0, -32.0, 8.0) - b.vertices[v]));
    }
    EXPECT_LT(worst, 1e-12 * 64.0);
  }
}

TEST_F(Fracture, EveryComponentBecomesAFragmentAndSmallComponentsAreDropped) {
  TriangleMesh mesh = shapes::append(shapes::cube(1.0), shapes::cube(1.0, {2.0, 0, 0}));
  mesh = shapes::append(mesh, shapes::cube(0.08, {1.0, 0.0, 0.0}));  // about 2 voxels wide
  const FractureResult result =
      fracture(mesh, {.pieces = 1, .solid = {.voxelSize = 0.04}}, device());
  EXPECT_EQ(result.components, 2u);
  EXPECT_EQ(result.fragments.size(), 2u);
  EXPECT_EQ(result.solid.smallComponents, 1u);
  EXPECT_EQ(result.solid.voxels, 2u * 25 * 25 * 25);
  EXPECT_GT(result.solid.smallComponentVoxels, 0u);
  EXPECT_LT(result.solid.smallComponentVoxels, 27u);
  EXPECT_NEAR(volume(result.fragments[0].mesh), 1.0, 0.02);
}

TEST_F(Fracture, AnInvertedMeshIsTurnedOver) {
  const FractureResult result = fracture(shapes::inverted(shapes::ball(1.0)),
                                         {.pieces = 2, .solid = {.resolution = 32}}, device());
  EXPECT_NEAR(volume(result.fragments[0].mesh) + volume(result.fragments[1].mesh),
              shapes::ballVolume(1.0), 0.15);
}

TEST_F(Fracture, ABallInACavityIsAComponentOfItsOwn) {
  const TriangleMesh mesh = shapes::append(shapes::hollowBall(1.0, 0.7), shapes::ball(0.4));
  const FractureResult result =
      fracture(mesh, {.pieces = 2, .solid = {.resolution = 64}}, device());
  EXPECT_EQ(result.components, 2u);
  const double out = volume(result.fragments[0].mesh) + volume(result.fragments[1].mesh);
  EXPECT_NEAR(out, shapes::hollowBallVolume(1.0, 0.7) + shapes::ballVolume(0.4), 0.02 * out);
}

TEST_F(Fracture, RefusesWhatItCannotBreak) {
  EXPECT_THROW((void)fracture(shapes::cube(1.0), {.solid = {.resolution = 4097}}, device()), Error);
  EXPECT_THROW(
      (void)fracture(shapes::cube(1.0), {.pieces = 1000, .solid = {.resolution = 8}}, device()),
      Error);
  EXPECT_THROW((void)fracture(shapes::cube(1.0), {.solid = {.voxelSize = 1e-9}}, device()), Error);
  for (const int pieces : {0, -1, std::numeric_limits<int>::min()}) {
    EXPECT_THROW(
        (void)fracture(shapes::cube(1.0), {.pieces = pieces, .solid = {.resolution = 8}}, device()),
        Error);
  }
}

TEST(PreparedSolid, GivesTheSameFracturesAndNeedsNoNewBuffersAfterTheFirst) {
  Device device, other;
  const Solid solid = voxelize(shapes::torus(10.0, 4.0), {.resolution = 48});
  PreparedSolid ready = prepared(solid, device);
  ready.surface = intactSurface(ready.solid);
  std::size_t buffers = 0;
  for (int i = 0; i < 18; ++i) {
    const int pieces = 2 + i % 9;
    FractureOptions options;
    options.pieces = pieces;
    options.seed = static_cast<std::uint64_t>(pieces);
    options.seeds.extraSeedsPerPiece = 2;
    options.grow.tuning.warmUp = i == 0;
    const FractureResult again = fracture(ready, options, device);
    // Disconnected voxels need buffers for the leaves around them, once.
    const bool mayAllocate = i == 0 || (i < 9 && again.labels.disconnected.front() > 0);
    if (mayAllocate) buffers = device.memory().buffersCreated;
    EXPECT_EQ(device.memory().buffersCreated, buffers) << pieces << " pieces";
    const FractureResult alone = fracture(solid, options, other);
    EXPECT_EQ(again.labels.fragment, alone.labels.fragment);
    for (std::size_t f = 0; f < again.fragments.size(); ++f) {
      EXPECT_EQ(again.fragments[f].mesh.vertices, alone.fragments[f].mesh.vertices);
      EXPECT_EQ(again.fragments[f].mesh.triangles, alone.fragments[f].mesh.triangles);
      EXPECT_EQ(again.fragments[f].mesh.neighbor, alone.fragments[f].mesh.neighbor);
    }
  }
  EXPECT_GT(device.memory().bytes, 0u);
  device.freeBuffers();
  EXPECT_EQ(device.memory().bytes, 0u);
}

TEST(FractureWithoutLevelSets, HasTheSameMeshes) {
  Device device;
  const Solid solid = voxelize(shapes::torus(10.0, 4.0), {.resolution = 64});
  for (const int iterations : {0, 3}) {
    FractureOptions options;
    options.pieces = 9;
    options.seeds.extraSeedsPerPiece = 2;
    options.erode.iterations = iterations;
    const FractureResult with = fracture(solid, options, device);
    options.surface.levelSets = false;
    const FractureResult without = fracture(solid, options, device);
    ASSERT_EQ(with.fragments.size(), without.fragments.size());
    for (std::size_t i = 0; i < with.fragments.size(); ++i) {
      EXPECT_NE(with.fragments[i].surface, nullptr);
      EXPECT_EQ(without.fragments[i].surface, nullptr);
      EXPECT_EQ(with.fragments[i].mesh.vertices, without.fragments[i].mesh.vertices);
      EXPECT_EQ(with.fragments[i].mesh.triangles, without.fragments[i].mesh.triangles);
      EXPECT_EQ(with.fragments[i].mesh.neighbor, without.fragments[i].mesh.neighbor);
    }
  }
}

TEST(PreparedSolid, GrowsSeveralTogetherAsEachAlone) {
  Device device, other;
  const PreparedSolid ready =
      prepared(voxelize(shapes::torus(10.0, 4.0), {.resolution = 48}), device);
  for (const bool eroded : {false, true}) {
    std::vector<FractureOptions> options(3);
    for (std::size_t i = 0; i < options.size(); ++i) {
      options[i].pieces = 3 + 2 * static_cast<int>(i);
      options[i].seed = 7 * i;
      options[i].seeds.extraSeedsPerPiece = 2;
      options[i].grow.roughness = 1.0;
      options[i].grow.tuning.warmUp = true;
      options[i].dropShare = 0.02;
      options[i].erode.iterations = eroded ? 2 : 0;
    }
    const std::vector<GrownFracture> together =
        growTogether(ready, options, device, StageClock(), nullptr);
    const std::size_t buffers = device.memory().buffersCreated;
    EXPECT_EQ(growTogether(ready, options, device, StageClock(), nullptr).size(), options.size());
    EXPECT_EQ(
        growTogether(ready, std::span(options).first(2), device, StageClock(), nullptr).size(), 2u);
    EXPECT_EQ(device.memory().buffersCreated, buffers);
    ASSERT_EQ(together.size(), options.size());
    for (std::size_t i = 0; i < options.size(); ++i) {
      const GrownFracture alone = grow(ready, options[i], other, StageClock(), nullptr);
      EXPECT_EQ(together[i].result.labels.fragment, alone.result.labels.fragment) << i;
      EXPECT_EQ(together[i].result.eroded, alone.result.eroded) << i;
      EXPECT_EQ(together[i].result.labels.fragmentCount, alone.result.labels.fragmentCount) << i;
      EXPECT_EQ(together[i].result.withheld, alone.result.withheld) << i;
    }
  }
}

TEST_F(Fracture, RefusesPiecesAndSeedsOfAStage) {
  const TriangleMesh ball = shapes::ball(1.0);
  const auto codeOf = [&](const FractureOptions& options) {
    try {
      (void)fracture(ball, options, device());
    } catch (const Error& e) {
      return e.code();
    }
    return ErrorCode::internal;
  };
  FractureOptions set;
  set.seeds.pieces = 3;
  EXPECT_EQ(codeOf(set), ErrorCode::usage);
  set = {};
  set.seeds.seed = 1;
  EXPECT_EQ(codeOf(set), ErrorCode::usage);
  set = {};
  set.grow.noiseSeeds = {1};
  EXPECT_EQ(codeOf(set), ErrorCode::usage);
  set = {};
  set.grow.longestSideVoxels = 16.0;
  EXPECT_EQ(codeOf(set), ErrorCode::usage);
  set = {};
  set.erode.seed = 1;
  EXPECT_EQ(codeOf(set), ErrorCode::usage);
}

TEST_F(Fracture, LabelsOfOtherBlocksAreRefused) {
  const Solid solid = voxelize(shapes::ball(1.0), {.resolution = 16});
  const Solid other = voxelize(shapes::ball(1.0), {.resolution = 24});
  const std::vector<std::vector<Seed>> seeds{{{solid.box.min + (solid.box.dims() >> 1), 1}}};
  const Labels labels = grow(solid.blocks, seeds, device()).front();
  EXPECT_EQ(labels.fragmentCount, 1);
  EXPECT_EQ(extractFragments(solid, labels).size(), 1u);
  EXPECT_THROW((void)extractFragments(other, labels), Error);
}

// Square bars along x, turned about it by rounding: their creases are at right angles up to that.
TEST_F(Fracture, CreasesAtRightAnglesUpToRoundingGiveFiniteNumbers) {
  constexpr int kBars = 12;
  TriangleMesh bars;
  for (int bar = 0; bar < kBars; ++bar) {
    const TriangleMesh box = shapes::box({8.0, 1.0, 1.0});
    const auto first = static_cast<std::uint32_t>(bars.vertices.size());
    const double angle = (bar - 5.5) * 4e-16;
    for (const glm::dvec3& v : box.vertices) {
      const double y = v.y + 0.5, z = v.z + 0.5;
      bars.vertices.emplace_back(v.x, y - angle * z, 3.0 * bar + z + angle * y);
    }
    for (const glm::uvec3& t : box.triangles) bars.triangles.push_back(t + first);
  }
  const FractureResult result =
      fracture(bars, {.pieces = kBars, .solid = {.resolution = 250}}, device());
  double sum = 0.0, areas = 0.0;
  for (const Fragment& fragment : result.fragments) {
    for (const glm::dvec3& v : fragment.mesh.vertices)
      ASSERT_TRUE(std::isfinite(v.x + v.y + v.z)) << fragment.id;
    sum += fragment.mass.volume;
    areas += fragment.area;
  }
  // Their creases and corners are vertices, so that the meshes are the bars.
  EXPECT_NEAR(sum, kBars * 8.0, 1e-6);
  EXPECT_NEAR(areas, kBars * 34.0, 1e-6);
}

// A number that is none, however it came about, passes through no function of the library.
TEST_F(Fracture, NoNumberThatIsNotFiniteIsReturned) {
  const auto refuses = [](const auto& make) {
    try {
      (void)make();
      ADD_FAILURE();
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("finite"), std::string::npos) << e.what();
    }
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  FractureResult whole =
      fracture(shapes::ball(1.0), {.pieces = 3, .solid = {.resolution = 24}}, device());
  const auto damaged = whole.solid.distance->deepCopy();
  for (auto value = damaged->beginValueOn(); value; ++value) {
    if (std::abs(*value) < 0.3f * static_cast<float>(damaged->voxelSize().x())) {
      value.setValue(static_cast<float>(nan));
      break;
    }
  }
  Solid solid = whole.solid;
  solid.distance = damaged;
  refuses([&] { return extractFragments(solid, whole.labels); });
  refuses([&] { return samplePoints(solid, whole.labels, {.points = {.count = 5000}}); });

  TriangleMesh& mesh = whole.fragments[0].mesh;
  const auto face = std::find_if(mesh.neighbor.begin(), mesh.neighbor.end(),
                                 [](std::uint16_t neighbor) { return neighbor > 0; });
  ASSERT_NE(face, mesh.neighbor.end());
  mesh.vertices[mesh.triangles[static_cast<std::size_t>(face - mesh.neighbor.begin())].x].z = nan;
  refuses([&] { return sampleCorrespondences(whole.fragments, 10, 0); });
}

// Whatever makes a number that is none, no fracture with it is returned.
TEST(FiniteNumbers, AreRequiredOfFragmentsContactsPointsAndManifests) {
  const auto refuses = [](const auto& check, const char* what) {
    try {
      check();
      ADD_FAILURE() << what;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::internal);
      EXPECT_NE(std::string(e.what()).find("fragment 7, stage "), std::string::npos) << e.what();
    }
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    Fragment sound;
    sound.id = 7;
    sound.mesh = shapes::cube(1.0);
    sound.coarse = {shapes::cube(1.0)};
    sound.mass = massProperties(sound.mesh);
    EXPECT_NO_THROW(checkFinite(sound));
    const auto changed = [&](const auto& change, const char* what) {
      Fragment fragment = sound;
      change(fragment);
      refuses([&] { checkFinite(fragment); }, what);
    };
    for (int axis = 0; axis < 3; ++axis) {
      changed([&](Fragment& f) { f.mesh.vertices[5][axis] = bad; }, "vertex");
      changed([&](Fragment& f) { f.coarse[0].vertices[2][axis] = bad; }, "coarse vertex");
      changed([&](Fragment& f) { f.mass.centroid[axis] = bad; }, "centroid");
      changed([&](Fragment& f) { f.mass.inertia[axis][2] = bad; }, "inertia");
    }
    changed([&](Fragment& f) { f.mass.volume = bad; }, "volume");
    changed([&](Fragment& f) { f.area = bad; }, "area");
    changed([&](Fragment& f) { f.fractureArea = bad; }, "fracture area");
    std::vector<std::vector<Contact>> contacts(8);
    contacts[6].emplace_back().area = 1.0;
    EXPECT_NO_THROW(checkFinite(contacts));
    contacts[6][0].centroid.y = bad;
    refuses([&] { checkFinite(contacts); }, "contact");
    refuses([&] { requireFinite({{{0, bad, 0}}, {{0, 0, 1}}, {0}}, 7); }, "point");
    refuses([&] { requireFinite({{{0, 0, 0}}, {{bad, 0, 1}}, {0}}, 7); }, "normal");
    try {
      (void)jsonText({{"a", {{"b", {1.0, bad}}}}}, -1);
      ADD_FAILURE();
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("a.b[1] is not a finite number"), std::string::npos);
    }
  }
  EXPECT_EQ(jsonText({{"a", {1.5, nullptr}}}, -1), R"({"a":[1.5,null]})");
}

// The surface of one ball is not that of another on the same leaves.
TEST_F(Fracture, RefusesTheIntactSurfaceOfAnotherSolid) {
  const PreparedSolid one = prepared(voxelize(shapes::ball(1.0), {.resolution = 32}), device());
  PreparedSolid other =
      prepared(voxelize(shapes::ball(1.01), {.voxelSize = one.solid.frame.voxelSize}), device());
  ASSERT_EQ(one.solid.blocks->count(), other.solid.blocks->count());
  other.surface = intactSurface(one.solid);
  EXPECT_THROW((void)fracture(other, {.pieces = 3}, device()), Error);
  other.surface = intactSurface(other.solid);
  EXPECT_EQ(fracture(other, {.pieces = 3}, device()).fragments.size(), 3u);
}

// A program that reads values which were never written has no constant result.
TEST(PassedCells, ReadNothingThatIsNotThere) {
  constexpr LabelCube<2> kCorners{1, 1, 1, 1, 1, 1, 1, 2};
  constexpr PassedCells<2> kPassed = passedCells<2>(kCorners);
  static_assert(kPassed.crossed[0] == 1 && kPassed.cut[0] == 1);
  constexpr LabelCube<3> kHalf{0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 3, 3, 3, 3,
                               3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3};
  constexpr PassedCells<3> kSurface = passedCells<3>(kHalf);
  static_assert(kSurface.crossed[0] == 3 && kSurface.cut[0] == 0 && kSurface.crossed[3] == 0);
  EXPECT_EQ(kSurface.crossed[1], 3);
}

}  // namespace
}  // namespace sherd
