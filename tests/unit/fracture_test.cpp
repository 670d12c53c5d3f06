// The promises of a fracture, on shapes whose volume and surface are known.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <sherd/error.h>
#include <sherd/fracture.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "fracture_stages.h"
#include "kernels/device_fixture.h"
#include "kernels/voxel_shapes.h"
#include "shapes.h"

namespace sherd {
namespace {

using openvdb::Coord;

struct Case {
  const char* name;
  TriangleMesh mesh;
  double volume;  // of the ideal shape
  std::function<double(const glm::dvec3&)>
      distance;  // to the ideal surface; empty where it has edges
  double longest;
};

double boxDistance(const glm::dvec3& p, double half) {
  const glm::dvec3 d = glm::abs(p) - half;
  return std::abs(std::max({d.x, d.y, d.z}));
}

// Two balls of radius r, centres 2a apart: the lens that both hold counts once.
double overlappingBallsVolume(double r, double a) {
  const double h = r - a;
  return 2 * shapes::ballVolume(r) - 2 * std::acos(-1.0) * h * h * (3 * r - h) / 3;
}

std::vector<Case> cases() {
  const auto sphere = [](double r, double x = 0.0) {
    return [=](const glm::dvec3& p) { return std::abs(glm::length(p - glm::dvec3(x, 0, 0)) - r); };
  };
  return {
      {"ball", shapes::ball(1.0, 6), shapes::ballVolume(1.0), sphere(1.0), 2.0},
      {"cube", shapes::cube(2.0), 8.0, [](const glm::dvec3& p) { return boxDistance(p, 1.0); },
       2.0},
      {"torus", shapes::torus(1.0, 0.4, 256, 128), shapes::torusVolume(1.0, 0.4),
       [](const glm::dvec3& p) {
         return std::abs(std::hypot(std::hypot(p.x, p.y) - 1.0, p.z) - 0.4);
       },
       2.8},
      {"cup",
       shapes::cup(1.0, 0.15, 1.6, 0.2, 256),
       shapes::cupVolume(1.0, 0.15, 1.6, 0.2),
       {},
       2.0},
      {"hollow ball", shapes::hollowBall(1.0, 0.6, 6), shapes::hollowBallVolume(1.0, 0.6),
       [=](const glm::dvec3& p) { return std::min(sphere(1.0)(p), sphere(0.6)(p)); }, 2.0},
      {"two overlapping balls",
       shapes::append(shapes::ball(1.0, 6, {-0.6, 0, 0}), shapes::ball(1.0, 6, {0.6, 0, 0})),
       overlappingBallsVolume(1.0, 0.6),
       [=](const glm::dvec3& p) { return std::min(sphere(1.0, -0.6)(p), sphere(1.0, 0.6)(p)); },
       3.2},
  };
}

// Bodies of a mesh: components of positive volume (a cavity's is negative).
int bodies(const TriangleMesh& mesh) {
  const Components parts = components(mesh);
  std::vector<double> volumes(parts.count);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    volumes[parts.ofTriangle[t]] += volume({mesh.vertices, {mesh.triangles[t]}});
  }
  return static_cast<int>(
      std::count_if(volumes.begin(), volumes.end(), [](double v) { return v > 0; }));
}

using Fracture = DeviceTest;

class Promises : public DeviceTest,
                 public testing::WithParamInterface<std::pair<std::size_t, Interface>> {};

TEST_P(Promises, HoldOnAnalyticShapes) {
  const Case shape = cases()[GetParam().first];
  const SurfaceOptions surface{.interface = GetParam().second};
  SCOPED_TRACE(shape.name);
  constexpr int kPieces = 10, kResolution = 128;
  const double h = shape.longest / kResolution;
  const FractureResult result = fracture(
      shape.mesh, {.pieces = kPieces, .seed = 3, .resolution = kResolution, .surface = surface},
      device());
  const Solid& solid = result.solid;
  ASSERT_EQ(result.fragments.size(), std::size_t{kPieces});
  EXPECT_NEAR(solid.frame.voxelSize, h, 1e-9 * h);

  // The solid is the shape: half a voxel over its surface is the most that centres can be wrong by;
  // on average much less, so a cavity or an overlap counted twice stands far outside.
  const double skin = area(shape.mesh);
  EXPECT_NEAR(static_cast<double>(solid.voxels) * h * h * h, shape.volume, 0.1 * h * skin);
  const TriangleMesh whole = solidMesh(solid);
  EXPECT_NEAR(volume(whole), shape.volume, 0.005 * shape.volume);

  // 1. Each inside voxel has one label, and the counts agree.
  const std::vector<std::uint64_t> counts = countVoxels(solid.blocks, result.labels, kPieces);
  EXPECT_EQ(counts[0], 0u);
  std::uint64_t sum = 0;
  double volumes = 0.0;
  for (const Fragment& fragment : result.fragments) {
    SCOPED_TRACE("fragment " + std::to_string(fragment.id));
    EXPECT_EQ(fragment.voxels, counts[static_cast<std::size_t>(fragment.id)]);
    sum += fragment.voxels;

    // 2. Connected, closed, edge-manifold, outwards, one body.
    voxel_shapes::VoxelSolid piece;
    for (std::size_t v = 0; v < result.labels.fragment.size(); ++v) {
      const bool isInside = (solid.blocks.inside[v >> 6] >> (v & 63)) & 1;
      if (isInside && result.labels.fragment[v] == fragment.id) {
        piece.inside.insert(solid.blocks.origins[v / 512] +
                            coordFromOffset(static_cast<std::uint32_t>(v % 512)));
      }
    }
    std::set<Coord> left = piece.inside;
    std::vector<Coord> stack{*left.begin()};
    left.erase(left.begin());
    while (!stack.empty()) {
      const Coord v = stack.back();
      stack.pop_back();
      for (const Coord& n : voxel_shapes::neighbours(v)) {
        if (left.erase(n)) stack.push_back(n);
      }
    }
    EXPECT_TRUE(left.empty()) << left.size() << " voxels are cut off";
    EXPECT_EQ(nonManifoldEdges(fragment.mesh), 0u);
    EXPECT_EQ(bodies(fragment.mesh), 1);
    EXPECT_GT(volume(fragment.mesh), 0.0);
    EXPECT_NEAR(volume(fragment.mesh), static_cast<double>(fragment.voxels) * h * h * h,
                0.5 * h * fragment.area);
    volumes += volume(fragment.mesh);

    // Facing names neighbours, each of them is a contact, and contacts know their other side.
    ASSERT_EQ(fragment.facing.size(), fragment.mesh.triangles.size());
    for (const int other : std::set<int>(fragment.facing.begin(), fragment.facing.end())) {
      ASSERT_LE(other, kPieces);
      ASSERT_NE(other, fragment.id);
      EXPECT_TRUE(other == 0 || std::any_of(fragment.contacts.begin(), fragment.contacts.end(),
                                            [&](const Contact& c) { return c.fragment == other; }))
          << "no contact with " << other;
    }
    for (const Contact& contact : fragment.contacts) {
      const Fragment& other = result.fragments[static_cast<std::size_t>(contact.fragment) - 1];
      const auto back = std::find_if(other.contacts.begin(), other.contacts.end(),
                                     [&](const Contact& c) { return c.fragment == fragment.id; });
      ASSERT_NE(back, other.contacts.end());
      EXPECT_EQ(back->area, contact.area);
      EXPECT_EQ(back->normal, -contact.normal);
    }
  }
  EXPECT_EQ(sum, solid.voxels);

  // 3. Volumes add up.
  EXPECT_NEAR(volumes, volume(whole), 0.0025 * volume(whole));

  // No voxel centre in two level sets, each in its owner's.
  std::vector<openvdb::FloatGrid::ConstAccessor> accessors;
  for (const Fragment& fragment : result.fragments)
    accessors.push_back(fragment.surface->getConstAccessor());
  std::size_t notInOwn = 0, inOther = 0;
  for (std::size_t v = 0; v < result.labels.fragment.size(); ++v) {
    if (!((solid.blocks.inside[v >> 6] >> (v & 63)) & 1)) continue;
    const Coord at =
        solid.blocks.origins[v / 512] + coordFromOffset(static_cast<std::uint32_t>(v % 512));
    for (std::size_t i = 0; i < accessors.size(); ++i) {
      const bool isIn = accessors[i].getValue(at) < 0;
      const bool owns = result.labels.fragment[v] == i + 1;
      notInOwn += owns && !isIn;
      inOther += !owns && isIn;
    }
  }
  EXPECT_EQ(notInOwn, 0u);
  EXPECT_EQ(inOther, 0u);

  // 4. The original surface stays where it was.
  if (!shape.distance) return;
  double error = 0.0;
  std::size_t vertices = 0;
  for (const Fragment& fragment : result.fragments) {
    std::set<unsigned> original;
    for (std::size_t t = 0; t < fragment.facing.size(); ++t) {
      if (fragment.facing[t] == 0) {
        for (int k = 0; k < 3; ++k) original.insert(fragment.mesh.triangles[t][k]);
      }
    }
    for (const unsigned v : original) error += shape.distance(fragment.mesh.vertices[v]) / h;
    vertices += original.size();
  }
  EXPECT_LT(error / static_cast<double>(vertices), 0.02)
      << "mean error of " << vertices << " vertices, voxels";
}

std::vector<std::pair<std::size_t, Interface>> everyShape() {
  std::vector<std::pair<std::size_t, Interface>> all{{0, Interface::independent},
                                                     {3, Interface::independent}};
  for (std::size_t i = 0; i < cases().size(); ++i) all.push_back({i, Interface::shared});
  return all;
}
INSTANTIATE_TEST_SUITE_P(Shapes, Promises, testing::ValuesIn(everyShape()));

TEST_F(Fracture, OnePieceReturnsTheSolid) {
  for (const Interface interface : {Interface::shared, Interface::independent}) {
    const SurfaceOptions surface{.interface = interface};
    const FractureResult result = fracture(
        shapes::torus(1.0, 0.4), {.pieces = 1, .resolution = 64, .surface = surface}, device());
    ASSERT_EQ(result.fragments.size(), 1u);
    const Fragment& piece = result.fragments[0];
    const TriangleMesh whole = solidMesh(result.solid);
    EXPECT_TRUE(piece.mesh.triangles == whole.triangles);
    EXPECT_TRUE(piece.mesh.vertices == whole.vertices);
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
  const FractureResult result =
      fracture(shapes::ball(1.0, 5), {.pieces = 2, .seed = 5, .resolution = 96}, device());
  ASSERT_EQ(result.fragments[0].contacts.size(), 1u);
  const Contact& contact = result.fragments[0].contacts[0];
  EXPECT_NEAR(contact.area,
              (result.fragments[0].fractureArea + result.fragments[1].fractureArea) / 2,
              1e-9 * contact.area);
  // The divergence theorem: over a closed surface area times normal adds up to nothing, so the
  // fracture faces' sum is minus the original faces'.
  for (const Fragment& piece : result.fragments) {
    glm::dvec3 sum(0.0), outer(0.0);
    for (std::size_t t = 0; t < piece.facing.size(); ++t) {
      const glm::uvec3& c = piece.mesh.triangles[t];
      const glm::dvec3 a = piece.mesh.vertices[c.x];
      (piece.facing[t] ? sum : outer) +=
          glm::cross(piece.mesh.vertices[c.y] - a, piece.mesh.vertices[c.z] - a) / 2.0;
    }
    EXPECT_NEAR(glm::length(sum + outer), 0.0, 1e-9);
    EXPECT_GT(glm::dot(glm::normalize(sum), piece.contacts[0].normal), 0.99);
    EXPECT_LE(glm::length(sum), contact.area * 1.05);
  }
}

TEST_F(Fracture, MovingAndScalingTheInputMovesAndScalesTheOutput) {
  const TriangleMesh mesh = shapes::cup(1.0, 0.25, 1.5, 0.25, 64);
  const FractureOptions options{.pieces = 6, .seed = 9, .resolution = 64};
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
    ASSERT_EQ(one.fragments[i].facing, moved.fragments[i].facing);
    double worst = 0.0;
    for (std::size_t v = 0; v < a.vertices.size(); ++v) {
      worst = std::max(
          worst, glm::length(a.vertices[v] * 4.0 + glm::dvec3(64.0, -32.0, 8.0) - b.vertices[v]));
    }
    EXPECT_LT(worst, 1e-12 * 64.0);
  }
}

TEST_F(Fracture, EveryPartBecomesAFragmentAndSpecksAreDropped) {
  TriangleMesh mesh = shapes::append(shapes::cube(1.0), shapes::cube(1.0, {2.0, 0, 0}));
  mesh = shapes::append(mesh, shapes::cube(0.08, {1.0, 0.0, 0.0}));  // about 2 voxels wide
  const FractureResult result = fracture(mesh, {.pieces = 1, .voxelSize = 0.04}, device());
  EXPECT_EQ(result.parts, 2u);
  EXPECT_EQ(result.fragments.size(), 2u);
  EXPECT_EQ(result.solid.specks, 1u);
  EXPECT_EQ(result.solid.voxels, 2u * 25 * 25 * 25);
  EXPECT_GT(result.solid.speckVoxels, 0u);
  EXPECT_LT(result.solid.speckVoxels, 27u);
  EXPECT_NEAR(volume(result.fragments[0].mesh), 1.0, 0.02);
}

TEST_F(Fracture, AnInvertedMeshIsTurnedOver) {
  const FractureResult result =
      fracture(shapes::inverted(shapes::ball(1.0)), {.pieces = 2, .resolution = 32}, device());
  EXPECT_NEAR(volume(result.fragments[0].mesh) + volume(result.fragments[1].mesh),
              shapes::ballVolume(1.0), 0.15);
}

TEST_F(Fracture, ABallInACavityIsAPartOfItsOwn) {
  const TriangleMesh mesh = shapes::append(shapes::hollowBall(1.0, 0.7), shapes::ball(0.4));
  const FractureResult result = fracture(mesh, {.pieces = 2, .resolution = 64}, device());
  EXPECT_EQ(result.parts, 2u);
  const double out = volume(result.fragments[0].mesh) + volume(result.fragments[1].mesh);
  EXPECT_NEAR(out, shapes::hollowBallVolume(1.0, 0.7) + shapes::ballVolume(0.4), 0.02 * out);
}

TEST_F(Fracture, RefusesWhatItCannotBreak) {
  EXPECT_THROW((void)fracture(shapes::cube(1.0), {.resolution = 4097}, device()), Error);
  EXPECT_THROW((void)fracture(shapes::cube(1.0), {.pieces = 1000, .resolution = 8}, device()),
               Error);
  EXPECT_THROW((void)fracture(shapes::cube(1.0), {.voxelSize = 1e-9}, device()), Error);
  for (const int pieces : {0, -1, std::numeric_limits<int>::min()}) {
    EXPECT_THROW((void)fracture(shapes::cube(1.0), {.pieces = pieces, .resolution = 8}, device()),
                 Error);
  }
}

TEST(PreparedSolid, GivesTheSameFracturesAndNeedsNoNewBuffersAfterTheFirst) {
  Device device, other;
  const Solid solid = voxelize(shapes::torus(10.0, 4.0), {.resolution = 48});
  PreparedSolid ready = prepared(solid, device);
  ready.surface = unbrokenSurface(ready.solid);
  std::size_t buffers = 0;
  for (int pieces = 2; pieces <= 10; ++pieces) {
    FractureOptions options;
    options.pieces = pieces;
    options.seed = static_cast<std::uint64_t>(pieces);
    options.extraSeedsPerPiece = 2;
    options.grow.rehearse = pieces == 2;
    const FractureResult again = fracture(ready, options, device);
    if (buffers == 0) buffers = device.memory().buffersCreated;
    EXPECT_EQ(device.memory().buffersCreated, buffers) << pieces << " pieces";
    const FractureResult alone = fracture(solid, options, other);
    EXPECT_EQ(again.labels.fragment, alone.labels.fragment);
    for (std::size_t i = 0; i < again.fragments.size(); ++i) {
      EXPECT_EQ(again.fragments[i].mesh.vertices, alone.fragments[i].mesh.vertices);
      EXPECT_EQ(again.fragments[i].mesh.triangles, alone.fragments[i].mesh.triangles);
      EXPECT_EQ(again.fragments[i].facing, alone.fragments[i].facing);
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
    options.extraSeedsPerPiece = 2;
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
      EXPECT_EQ(with.fragments[i].facing, without.fragments[i].facing);
    }
  }
}

TEST(PreparedSolid, GrowsSeveralTogetherAsEachAlone) {
  Device device, other;
  const PreparedSolid ready =
      prepared(voxelize(shapes::torus(10.0, 4.0), {.resolution = 48}), device);
  for (const bool worn : {false, true}) {
    std::vector<FractureOptions> options(3);
    for (std::size_t i = 0; i < options.size(); ++i) {
      options[i].pieces = 3 + 2 * static_cast<int>(i);
      options[i].seed = 7 * i;
      options[i].extraSeedsPerPiece = 2;
      options[i].grow.roughness = 1.0;
      options[i].grow.rehearse = true;
      options[i].dropShare = 0.02;
      options[i].erode.iterations = worn ? 2 : 0;
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
      EXPECT_EQ(together[i].result.worn, alone.result.worn) << i;
      EXPECT_EQ(together[i].fragments, alone.fragments) << i;
      EXPECT_EQ(together[i].result.withheld, alone.result.withheld) << i;
    }
  }
}

}  // namespace
}  // namespace sherd
