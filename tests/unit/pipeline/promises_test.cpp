// What README promises of a fracture, on shapes whose volume and surface are known: one test for
// each promise.  What it promises of runs, files and input is tested in fracture_test.cpp and
// tests/cli.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "kernels/device_fixture.h"
#include "kernels/voxel_shapes.h"
#include "pipeline/fracture_stages.h"
#include "shapes.h"

namespace sherd {
namespace {

using openvdb::Coord;

struct Shape {
  TriangleMesh mesh;
  double volume;  // of the ideal shape
  std::function<double(const glm::dvec3&)>
      distance;  // to the ideal surface; empty where it is not known
  double longest;
};

double boxDistance(const glm::dvec3& p, double half) {
  const glm::dvec3 d = glm::abs(p) - half;
  return std::abs(std::max({d.x, d.y, d.z}));
}

// Two balls of radius r, centers 2a apart: the lens that both hold counts once.
double overlappingBallsVolume(double r, double a) {
  const double h = r - a;
  return 2 * shapes::ballVolume(r) - 2 * std::acos(-1.0) * h * h * (3 * r - h) / 3;
}

auto sphere(double r, double x = 0.0) {
  return [=](const glm::dvec3& p) { return std::abs(glm::length(p - glm::dvec3(x, 0, 0)) - r); };
}

Shape ball() { return {shapes::ball(1.0, 6), shapes::ballVolume(1.0), sphere(1.0), 2.0}; }

Shape cube() {
  return {shapes::cube(2.0), 8.0, [](const glm::dvec3& p) { return boxDistance(p, 1.0); }, 2.0};
}

Shape torus() {
  return {shapes::torus(1.0, 0.4, 256, 128), shapes::torusVolume(1.0, 0.4),
          [](const glm::dvec3& p) {
            return std::abs(std::hypot(std::hypot(p.x, p.y) - 1.0, p.z) - 0.4);
          },
          2.8};
}

Shape cup() {
  return {shapes::cup(1.0, 0.15, 1.6, 0.2, 256), shapes::cupVolume(1.0, 0.15, 1.6, 0.2), {}, 2.0};
}

Shape hollowBall() {
  return {shapes::hollowBall(1.0, 0.6, 6), shapes::hollowBallVolume(1.0, 0.6),
          [](const glm::dvec3& p) { return std::min(sphere(1.0)(p), sphere(0.6)(p)); }, 2.0};
}

Shape overlappingBalls() {
  return {shapes::append(shapes::ball(1.0, 6, {-0.6, 0, 0}), shapes::ball(1.0, 6, {0.6, 0, 0})),
          overlappingBallsVolume(1.0, 0.6),
          [](const glm::dvec3& p) { return std::min(sphere(1.0, -0.6)(p), sphere(1.0, 0.6)(p)); },
          3.2};
}

// Bodies of a mesh: components of positive volume (a cavity's is negative).
int bodies(const TriangleMesh& mesh) {
  const MeshComponents components = meshComponents(mesh);
  std::vector<double> volumes(components.count);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corners = mesh.triangles[t];
    const glm::dvec3 &a = mesh.vertices[corners.x], &b = mesh.vertices[corners.y],
                     &c = mesh.vertices[corners.z];
    volumes[components.ofTriangle[t]] += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  return static_cast<int>(
      std::count_if(volumes.begin(), volumes.end(), [](double v) { return v > 0; }));
}

constexpr int kPieces = 10, kResolution = 128;

struct Case {
  const char* name;
  Shape (*shape)();
  Interface interface;
};

struct Broken {
  Shape shape;
  FractureResult result;
  TriangleMesh whole;  // the unbroken solid's
};

Broken broken(const Case& of, Device& device) {
  Shape shape = of.shape();
  const FractureOptions options{.pieces = kPieces,
                                .seed = 3,
                                .solid = {.resolution = kResolution},
                                .surface = {.interface = of.interface}};
  FractureResult result = fracture(shape.mesh, options, device);
  TriangleMesh whole = solidMesh(result.solid);
  return {std::move(shape), std::move(result), std::move(whole)};
}

// Breaks each shape once for all promises.
class Promises : public DeviceTest, public testing::WithParamInterface<Case> {
 protected:
  const Broken& broken() const {
    static std::map<std::string, Broken> all;
    const auto found = all.find(GetParam().name);
    if (found != all.end()) return found->second;
    return all.emplace(GetParam().name, sherd::broken(GetParam(), device())).first->second;
  }
  double voxel() const { return broken().shape.longest / kResolution; }
};

// What the others rest on: half a voxel over its surface is the most that centers can be wrong by;
// on average much less, so a cavity or an overlap counted twice stands far outside.
TEST_P(Promises, TheSolidIsTheShape) {
  const auto& [shape, result, whole] = broken();
  const Solid& solid = result.solid;
  const double h = voxel();
  EXPECT_NEAR(solid.frame.voxelSize, h, 1e-9 * h);
  EXPECT_NEAR(static_cast<double>(solid.voxels) * h * h * h, shape.volume,
              0.1 * h * area(shape.mesh));
  EXPECT_NEAR(volume(whole), shape.volume, 0.005 * shape.volume);
}

TEST_P(Promises, EveryVoxelHasOneLabel) {
  const FractureResult& result = broken().result;
  ASSERT_EQ(result.fragments.size(), std::size_t{kPieces});
  const std::vector<std::uint64_t> counts = countVoxels(result.labels);
  EXPECT_EQ(counts[0], 0u);
  std::uint64_t sum = 0;
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(fragment.voxels, counts[static_cast<std::size_t>(fragment.id)]) << fragment.id;
    sum += fragment.voxels;
  }
  EXPECT_EQ(sum, result.solid.voxels);
}

std::set<Coord> voxelsOf(const Fragment& fragment, const FractureResult& result) {
  const LeafBlocks& blocks = *result.solid.blocks;
  std::set<Coord> all;
  for (std::size_t v = 0; v < result.labels.fragment.size(); ++v) {
    const bool isInside = (blocks.inside[v >> 6] >> (v & 63)) & 1;
    if (isInside && result.labels.fragment[v] == fragment.id)
      all.insert(blocks.origins[v / 512] + coordFromOffset(static_cast<std::uint32_t>(v % 512)));
  }
  return all;
}

// How many voxels cannot be reached from the first over faces.
std::size_t cutOff(std::set<Coord> left) {
  std::vector<Coord> stack{*left.begin()};
  left.erase(left.begin());
  while (!stack.empty()) {
    const Coord v = stack.back();
    stack.pop_back();
    for (const Coord& n : voxel_shapes::neighbors(v)) {
      if (left.erase(n)) stack.push_back(n);
    }
  }
  return left.size();
}

TEST_P(Promises, FragmentsAreConnectedAndTheirMeshesClosed) {
  const FractureResult& result = broken().result;
  const double h = voxel();
  for (const Fragment& fragment : result.fragments) {
    SCOPED_TRACE("fragment " + std::to_string(fragment.id));
    EXPECT_EQ(cutOff(voxelsOf(fragment, result)), 0u);
    EXPECT_EQ(nonManifoldEdges(fragment.mesh), 0u);
    EXPECT_EQ(bodies(fragment.mesh), 1);
    EXPECT_GT(volume(fragment.mesh), 0.0);
    EXPECT_NEAR(volume(fragment.mesh), static_cast<double>(fragment.voxels) * h * h * h,
                0.5 * h * fragment.area);
  }
}

TEST_P(Promises, VolumesAddUp) {
  const auto& [shape, result, whole] = broken();
  double volumes = 0.0;
  for (const Fragment& fragment : result.fragments) volumes += volume(fragment.mesh);
  EXPECT_NEAR(volumes, volume(whole), 0.0025 * volume(whole));
}

TEST_P(Promises, ContactsKnowTheirOtherSide) {
  const FractureResult& result = broken().result;
  for (const Fragment& fragment : result.fragments) {
    SCOPED_TRACE("fragment " + std::to_string(fragment.id));
    ASSERT_EQ(fragment.mesh.neighbor.size(), fragment.mesh.triangles.size());
    for (const int other :
         std::set<int>(fragment.mesh.neighbor.begin(), fragment.mesh.neighbor.end())) {
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
}

TEST_P(Promises, NoVoxelLiesInTwoLevelSets) {
  const FractureResult& result = broken().result;
  std::vector<openvdb::FloatGrid::ConstAccessor> accessors;
  for (const Fragment& fragment : result.fragments)
    accessors.push_back(fragment.surface->getConstAccessor());
  std::size_t notInOwn = 0, inOther = 0;
  for (std::size_t v = 0; v < result.labels.fragment.size(); ++v) {
    if (!((result.solid.blocks->inside[v >> 6] >> (v & 63)) & 1)) continue;
    const Coord at = result.solid.blocks->origins[v / 512] +
                     coordFromOffset(static_cast<std::uint32_t>(v % 512));
    for (std::size_t i = 0; i < accessors.size(); ++i) {
      const bool isIn = accessors[i].getValue(at) < 0;
      const bool owns = result.labels.fragment[v] == i + 1;
      notInOwn += owns && !isIn;
      inOther += !owns && isIn;
    }
  }
  EXPECT_EQ(notInOwn, 0u);
  EXPECT_EQ(inOther, 0u);
}

// The same fractures, of shapes whose surface has a distance in closed form.
class KnownSurfaces : public Promises {};

TEST_P(KnownSurfaces, StayWhereTheyWere) {
  const auto& [shape, result, whole] = broken();
  const double h = voxel();
  double error = 0.0;
  std::size_t vertices = 0;
  for (const Fragment& fragment : result.fragments) {
    std::set<unsigned> original;
    for (std::size_t t = 0; t < fragment.mesh.neighbor.size(); ++t) {
      if (fragment.mesh.neighbor[t] == 0) {
        for (int k = 0; k < 3; ++k) original.insert(fragment.mesh.triangles[t][k]);
      }
    }
    for (const unsigned v : original) error += shape.distance(fragment.mesh.vertices[v]) / h;
    vertices += original.size();
  }
  EXPECT_LT(error / static_cast<double>(vertices), 0.02)
      << "mean error of " << vertices << " vertices, voxels";
}

constexpr Case kKnown[] = {{"Ball", ball, Interface::shared},
                           {"Cube", cube, Interface::shared},
                           {"Torus", torus, Interface::shared},
                           {"HollowBall", hollowBall, Interface::shared},
                           {"OverlappingBalls", overlappingBalls, Interface::shared},
                           {"BallOfIndependentSurfaces", ball, Interface::independent}};
constexpr Case kWithoutDistance[] = {{"Cup", cup, Interface::shared},
                                     {"CupOfIndependentSurfaces", cup, Interface::independent}};
constexpr auto nameOf = [](const auto& info) { return std::string(info.param.name); };
INSTANTIATE_TEST_SUITE_P(Shapes, Promises, testing::ValuesIn(kKnown), nameOf);
INSTANTIATE_TEST_SUITE_P(Cups, Promises, testing::ValuesIn(kWithoutDistance), nameOf);
INSTANTIATE_TEST_SUITE_P(Shapes, KnownSurfaces, testing::ValuesIn(kKnown), nameOf);

}  // namespace
}  // namespace sherd
