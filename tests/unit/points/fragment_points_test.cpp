// Points of fragments without meshes, against the meshes of the same fragments.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/fracture.h>
#include <sherd/points.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "cut/cut.h"
#include "folder/manifest/manifest.h"
#include "interface/contacts.h"
#include "interface/interface_surface.h"
#include "kernels/device_fixture.h"
#include "mesh/search/triangle_tree.h"
#include "pipeline/fracture_stages.h"
#include "points/sample_surface.h"
#include "shapes.h"
#include "surface/fragment_surfaces.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

struct Case {
  std::string name;
  TriangleMesh mesh;
  FractureOptions options;
};

// Cracks that are planes, are smoothed, are rough; edges, walls of a voxel, hollows, tiny
// fragments, sheets that touch; eroded surfaces.
std::vector<Case> cases() {
  const auto of = [](int resolution, int pieces, GrowOptions grow = {}) {
    FractureOptions options;
    options.solid.resolution = resolution;
    options.pieces = pieces;
    options.grow = grow;
    options.seed = 5;
    return options;
  };
  std::vector<Case> all{
      {"ball", shapes::ball(1.0, 5), of(48, 7)},
      {"cup", shapes::cup(1.0, 0.25, 1.6, 0.25), of(60, 9)},
      {"torus", shapes::torus(1.0, 0.4), of(40, 5, {.growth = Growth::flood})},
      {"hollow ball", shapes::hollowBall(1.0, 0.9), of(40, 6, {.roughness = 3.0})},
      {"thin cup", shapes::cup(1.0, 0.05, 1.6, 0.05), of(40, 8, {.growth = Growth::flood})},
      {"dust", shapes::ball(1.0, 4), of(24, 400, {.growth = Growth::flood})},
      {"one", shapes::ball(1.0, 4), of(24, 1)}};
  Case eroded{"eroded", shapes::cup(1.0, 0.25, 1.6, 0.25), of(60, 5)};
  eroded.options.erode.iterations = 2;
  all.push_back(eroded);
  return all;
}

// A fracture with and without meshes.
struct Both {
  PreparedSolid ready;
  FractureResult meshed, bare;
  std::optional<Labels> uneroded;
};

class FragmentPoints : public DeviceTest {
 protected:
  Both broken(const Case& of) {
    Both both;
    both.ready = prepared(voxelize(of.mesh, of.options.solid), device());
    both.ready.surface = intactSurface(both.ready.solid);
    FractureOptions options = of.options;
    options.surface.levelSets = false;
    options.surface.adaptivity = 0.0;  // the points of merged meshes are those of `bare`
    const GrownFracture grown = grow(both.ready, options, device(), StageClock(), nullptr);
    both.uneroded = grown.uneroded;
    both.meshed = extracted(grown, options, nullptr);
    options.surface.meshes = false;
    both.bare = extracted(grown, options, nullptr);
    return both;
  }
};

bool areEqual(const SurfacePoints& a, const SurfacePoints& b, std::size_t i) {
  return a.positions[i] == b.positions[i] && a.normals[i] == b.normals[i] &&
         a.neighbor[i] == b.neighbor[i];
}

// Both sum areas in another order, so a point may be of another triangle where it is within
// rounding of the triangle's end: once in about 10^9 points of these meshes.  Elimination and
// shuffles are of all points, so they differ as a whole then.
TEST_F(FragmentPoints, AreThoseOfTheMeshes) {
  for (const Case& of : cases()) {
    SCOPED_TRACE(of.name);
    const Both both = broken(of);
    for (const PointOptions& way : {PointOptions{.sampler = PointSampler::uniform},
                                    PointOptions{.sampler = PointSampler::halton},
                                    PointOptions{.sampler = PointSampler::poisson},
                                    PointOptions{.rule = PointRule::perTriangle}}) {
      PointOptions options = way;
      options.count = 307;
      options.seed = 17;
      const Labels* const uneroded = both.uneroded ? &*both.uneroded : nullptr;
      const std::vector<SurfacePoints> reusing =
          samplePoints(both.bare.solid, both.bare.labels, {options, uneroded, both.ready.surface});
      for (const auto& intact : {both.ready.surface, std::shared_ptr<const IntactSurface>()}) {
        const std::vector<SurfacePoints> found =
            samplePoints(both.bare.solid, both.bare.labels, {options, uneroded, intact});
        ASSERT_EQ(found.size(), both.meshed.fragments.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
          const Fragment& fragment = both.meshed.fragments[i];
          const SurfacePoints expected =
              samplePoints(fragment.mesh, pointOptionsOf(options, fragment.id));
          ASSERT_EQ(found[i].positions.size(), expected.positions.size());
          for (std::size_t k = 0; k < expected.positions.size(); ++k) {
            EXPECT_TRUE(areEqual(found[i], reusing[i], k));
          }
          std::size_t equal = 0;
          for (std::size_t k = 0; k < expected.positions.size(); ++k) {
            equal += areEqual(found[i], expected, k) ? 1 : 0;
          }
          EXPECT_GE(equal + 1, expected.positions.size())
              << "fragment " << fragment.id << " sampler " << static_cast<int>(way.sampler)
              << " rule " << static_cast<int>(way.rule);
        }
      }
    }
  }
}

// Points in proportion to area over original faces and each contact, on the mesh.
TEST_F(FragmentPoints, AreUniformOverBothPartsOfTheSurface) {
  constexpr std::size_t kCount = 200'000;
  for (const Case& of : {cases()[0], cases()[1], cases()[3]}) {
    SCOPED_TRACE(of.name);
    const Both both = broken(of);
    const std::vector<SurfacePoints> found =
        samplePoints(both.bare.solid, both.bare.labels,
                     {{.count = kCount, .seed = 3}, nullptr, both.ready.surface});
    const double voxel = both.bare.solid.frame.voxelSize;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const TriangleMesh& mesh = both.meshed.fragments[i].mesh;
      std::map<std::uint16_t, double> areas;
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::uvec3& c = mesh.triangles[t];
        areas[mesh.neighbor[t]] +=
            glm::length(glm::cross(mesh.vertices[c.y] - mesh.vertices[c.x],
                                   mesh.vertices[c.z] - mesh.vertices[c.x])) /
            2.0;
      }
      std::map<std::uint16_t, double> counts;
      const TriangleTree tree(mesh);
      for (std::size_t k = 0; k < kCount; ++k) {
        counts[found[i].neighbor[k]] += 1.0;
        if (k % 100 != 0) continue;
        EXPECT_LT(tree.nearest(found[i].positions[k], voxel).distance, 1e-9 * voxel);
      }
      double squares = 0.0;
      for (const auto& [neighbor, own] : areas) {
        const double expected = kCount * own / area(mesh);
        squares += (counts[neighbor] - expected) * (counts[neighbor] - expected) / expected;
      }
      EXPECT_EQ(counts.size(), areas.size());
      // Chi-square of areas.size() - 1 degrees of freedom: mean plus six standard deviations.
      const auto freedom = static_cast<double>(areas.size() - 1);
      EXPECT_LT(squares, freedom + 6.0 * std::sqrt(2.0 * std::max(freedom, 1.0)));
    }
  }
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance);
}

double areaOf(const TriangleMesh& mesh, std::size_t t) {
  const glm::uvec3& c = mesh.triangles[t];
  const glm::dvec3& a = mesh.vertices[c.x];
  return glm::length(glm::cross(mesh.vertices[c.y] - a, mesh.vertices[c.z] - a)) / 2.0;
}

// [neighbor] the area of a mesh that faces it.
std::map<std::uint16_t, double> areasByNeighbor(const TriangleMesh& mesh) {
  std::map<std::uint16_t, double> areas;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    areas[mesh.neighbor[t]] += areaOf(mesh, t);
  return areas;
}

// Pairs of labels whose voxels share a face.
std::set<std::pair<std::uint16_t, std::uint16_t>> touchingPairs(const Solid& solid,
                                                                const Labels& labels) {
  std::map<openvdb::Coord, std::uint16_t> at;
  solid.blocks->forEachInside(
      [&](std::size_t voxel) { at[solid.blocks->voxelAt(voxel)] = labels.fragment[voxel]; });
  std::set<std::pair<std::uint16_t, std::uint16_t>> pairs;
  for (const auto& [voxel, label] : at) {
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::Coord next = voxel;
      ++next[axis];
      const auto other = at.find(next);
      if (other == at.end() || other->second == label) continue;
      pairs.insert({std::min(label, other->second), std::max(label, other->second)});
    }
  }
  return pairs;
}

// Of all faces of the meshes, and of faces between voxels.
std::vector<std::vector<Contact>> contactsOfMeshes(const Both& both, const Labels& before) {
  const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(both.bare.solid.blocks->origins);
  ContactMeasure measure;
  for (const Fragment& fragment : both.meshed.fragments) measure.add(fragment);
  return measure.contacts(
      both.bare.fragments.size(),
      voxelContacts(both.bare.solid, before,
                    findCut(both.bare.labels, neighborhoods, CutExtent::none), neighborhoods));
}

struct ContactTolerance {
  double area, normal, centroid;
};

void expectNear(std::span<const Contact> a, std::span<const Contact> b,
                const ContactTolerance& tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].fragment, b[k].fragment);
    EXPECT_NEAR(a[k].area, b[k].area, tolerance.area);
    expectNear(a[k].normal, b[k].normal, tolerance.normal);
    expectNear(a[k].centroid, b[k].centroid, tolerance.centroid);
  }
}

// Sums of at most a million terms in another order.
TEST_F(FragmentPoints, FragmentsHaveTheMeasuresOfTheirMeshes) {
  constexpr double kRounding = 1e-10;
  for (const Case& of : cases()) {
    SCOPED_TRACE(of.name);
    const Both both = broken(of);
    ASSERT_EQ(both.bare.fragments.size(), both.meshed.fragments.size());
    ASSERT_NE(both.bare.surfaces, nullptr);
    const double size = longestSide(bounds(of.mesh));
    const std::vector<MeshFacts> facts = meshFacts(both.bare, {}),
                                 expected = meshFacts(std::span(both.meshed.fragments));
    const std::vector<std::size_t> vertices = both.bare.surfaces->vertexCounts();
    const Labels& before = both.uneroded ? *both.uneroded : both.bare.labels;
    const std::vector<std::vector<Contact>> expectedContacts = contactsOfMeshes(both, before);
    const auto pairs = touchingPairs(both.bare.solid, before);
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < both.bare.fragments.size(); ++i) {
      const Fragment &a = both.bare.fragments[i], &b = both.meshed.fragments[i];
      EXPECT_EQ(a.id, b.id);
      EXPECT_TRUE(a.mesh.vertices.empty());
      EXPECT_EQ(a.voxels, b.voxels);
      EXPECT_EQ(a.voxelBox.min, b.voxelBox.min);
      EXPECT_EQ(a.voxelBox.max, b.voxelBox.max);
      const MassProperties mass = massProperties(b.mesh);
      EXPECT_NEAR(a.mass.volume, mass.volume, kRounding * std::pow(size, 3));
      expectNear(a.mass.centroid, mass.centroid,
                 kRounding * std::pow(size, 4) / std::abs(mass.volume));
      for (int k = 0; k < 3; ++k) {
        expectNear(a.mass.inertia[k], mass.inertia[k], kRounding * std::pow(size, 5));
      }
      std::map<std::uint16_t, double> areas = areasByNeighbor(b.mesh);
      double area = 0.0;
      for (const auto& [neighbor, own] : areas) area += own;
      EXPECT_NEAR(a.area, area, kRounding * area);
      EXPECT_NEAR(a.fractureArea, area - areas[0], kRounding * area);
      EXPECT_EQ(vertices[i + 1], b.mesh.vertices.size());
      EXPECT_EQ(both.bare.surfaces->triangles(static_cast<std::uint16_t>(i + 1)),
                b.mesh.triangles.size());
      EXPECT_EQ(facts[i].box.min, expected[i].box.min);
      EXPECT_EQ(facts[i].box.max, expected[i].box.max);
      ASSERT_EQ(facts[i].boundaryLengths.size(), expected[i].boundaryLengths.size());
      for (const auto& [neighbor, length] : expected[i].boundaryLengths) {
        EXPECT_NEAR(facts[i].boundaryLengths.at(neighbor), length, kRounding * size);
      }
      contacts += a.contacts.size();
      expectNear(a.contacts, expectedContacts[i], {kRounding * area, 1e-6, 1e-6 * size});
      for (const Contact& contact : a.contacts) {
        const auto other = static_cast<std::uint16_t>(contact.fragment);
        const auto own = static_cast<std::uint16_t>(a.id);
        EXPECT_TRUE(pairs.contains({std::min(own, other), std::max(own, other)}));
        if (both.uneroded) continue;  // each side has receded on its own
        const TriangleMesh& across = both.meshed.fragments[other - 1u].mesh;
        EXPECT_NEAR(contact.area, (areas[other] + areasByNeighbor(across)[own]) / 2.0,
                    kRounding * area);
      }
    }
    EXPECT_EQ(contacts, 2 * pairs.size());
  }
}

// Leaf by leaf and eighth by eighth, whatever is the intact solid's.
TEST_F(FragmentPoints, MeasuresAreTheSameForOneFractureOrSeveral) {
  for (const Case& of : cases()) {
    SCOPED_TRACE(of.name);
    const Both both = broken(of);
    ExtractOptions options{.uneroded = both.uneroded ? &*both.uneroded : nullptr};
    options.surface.levelSets = false;
    options.surface.adaptivity = 0.0;
    const std::vector<Fragment> alone =
        extractFragments(both.meshed.solid, both.meshed.labels, options);
    for (std::size_t i = 0; i < alone.size(); ++i) {
      const Fragment& a = alone[i];
      for (const FractureResult* const result : {&both.meshed, &both.bare}) {
        const Fragment& b = result->fragments[i];
        EXPECT_EQ(a.mass.volume, b.mass.volume);
        EXPECT_EQ(a.mass.centroid, b.mass.centroid);
        EXPECT_EQ(a.mass.inertia, b.mass.inertia);
        EXPECT_EQ(a.area, b.area);
        EXPECT_EQ(a.fractureArea, b.fractureArea);
        ASSERT_EQ(a.contacts.size(), b.contacts.size());
        for (std::size_t k = 0; k < a.contacts.size(); ++k) {
          EXPECT_EQ(a.contacts[k].area, b.contacts[k].area);
          EXPECT_EQ(a.contacts[k].normal, b.contacts[k].normal);
          EXPECT_EQ(a.contacts[k].centroid, b.contacts[k].centroid);
        }
      }
      EXPECT_EQ(a.mesh.vertices, both.meshed.fragments[i].mesh.vertices);
      EXPECT_EQ(a.mesh.triangles, both.meshed.fragments[i].mesh.triangles);
      EXPECT_EQ(a.mesh.neighbor, both.meshed.fragments[i].mesh.neighbor);
    }
  }
}

// Beside cracks, and whatever the labels of the exterior band are.
TEST_F(FragmentPoints, TakeQuadsOfTheIntactSolid) {
  const Both both = broken(cases()[1]);
  const IntactSurface& intact = *both.ready.surface;
  const Cut cut = findCut(both.bare.labels, intact.neighborhoods, CutExtent::cells);
  const InterfaceSurface surface(both.bare.solid, both.bare.labels, cut, intact.neighborhoods,
                                 intact.creases, &intact, SurfaceVertices::all, nullptr);
  std::size_t leaves = 0, octants = 0, quads = 0, made = 0;
  for (std::size_t leaf = 0; leaf < surface.leaves(); ++leaf) {
    leaves += surface.reusesTriangles(leaf) ? 1 : 0;
    octants += static_cast<std::size_t>(std::popcount(surface.intactOctants(leaf)));
    for (const InterfaceQuad& quad : surface.quadsOf(leaf)) ++(quad.isIntact ? quads : made);
  }
  EXPECT_GT(leaves, 0u);
  EXPECT_GT(octants, leaves);
  EXPECT_GT(quads, made);
  std::size_t crossings = 0;
  for (const openvdb::Coord& origin : both.bare.solid.blocks->origins)
    crossings += intact.creases.crossings(origin).size();
  EXPECT_GT(crossings, 0u);
}

// A leaf without a cut has no cell with several labels.
TEST_F(FragmentPoints, CutEveryLeafWithCellsOfSeveralLabels) {
  for (const Case& of : cases()) {
    SCOPED_TRACE(of.name);
    const Both both = broken(of);
    const LeafBlocks& blocks = *both.bare.solid.blocks;
    const Cut cut = findCut(both.bare.labels, leafNeighbors(blocks.origins), CutExtent::cells);
    std::map<openvdb::Coord, std::uint16_t> at;
    blocks.forEachInside(
        [&](std::size_t voxel) { at[blocks.voxelAt(voxel)] = both.bare.labels.fragment[voxel]; });
    std::size_t whole = 0;
    for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
      if (cut.index[leaf] != Cut::kWhole) continue;
      ++whole;
      const openvdb::Coord low = blocks.origins[leaf] - openvdb::Coord(1);
      for (int i = 0; i < 1000; ++i) {  // the corners of all cells with a corner in the leaf
        const auto found = at.find(low + openvdb::Coord(i / 100, i / 10 % 10, i % 10));
        if (found != at.end()) {
          ASSERT_EQ(found->second, cut.only[leaf]) << "leaf " << leaf;
        }
      }
    }
    if (of.options.pieces < 10) {
      EXPECT_GT(whole, 0u);
    }
  }
}

TEST_F(FragmentPoints, RefuseWhatNeedsMeshes) {
  const std::vector<SurfaceOptions> refused{
      {.levelSets = true, .meshes = false},
      {.levelSets = false, .meshes = false, .surface = Surface::labels},
      {.levelSets = false, .meshes = false, .interface = Interface::independent},
      {.levelSets = false, .meshes = false, .smooth = {.iterations = {.count = 1}}},
      {.levelSets = false, .meshes = false, .adaptivity = 0.5},
      {.levelSets = false, .meshes = false, .triangles = {100}}};
  for (const SurfaceOptions& options : refused) {
    EXPECT_THROW(checkSurfaceOptions(options), Error);
  }
  EXPECT_NO_THROW(checkSurfaceOptions({.levelSets = false, .meshes = false}));
}

TEST_F(FragmentPoints, StopWhenAskedAndSampleNothingOfNothing) {
  const Both both = broken(cases()[1]);
  const Solid& solid = both.bare.solid;
  for (const SurfacePoints& none : samplePoints(solid, both.bare.labels, FragmentPointOptions{})) {
    EXPECT_TRUE(none.positions.empty());
  }
  const Progress stop{.report = {}, .cancelled = [] { return true; }};
  EXPECT_THROW((void)samplePoints(solid, both.bare.labels, {.points = {.count = 10}}, &stop),
               Error);
  EXPECT_THROW((void)samplePoints(solid, both.bare.labels, {.points = {.count = kMaxPoints + 1}}),
               Error);
  Labels other = both.bare.labels;
  other.fragment.resize(512);
  EXPECT_THROW((void)samplePoints(solid, other, {.points = {.count = 10}}), Error);
  other = both.bare.labels;
  other.blocks = nullptr;
  EXPECT_THROW((void)samplePoints(solid, other, {.points = {.count = 10}}), Error);
  const ExtractOptions bare{.surface = {.levelSets = false, .meshes = false}};
  EXPECT_THROW((void)extractFragments(solid, other, bare), Error);
  const auto foreign = intactSurface(voxelize(shapes::ball(1.0, 3), {.resolution = 20}));
  EXPECT_THROW((void)samplePoints(solid, both.bare.labels, {{.count = 10}, nullptr, foreign}),
               Error);
}

// Cancelled at any question, in any of its parts.
TEST_F(FragmentPoints, StopWherever) {
  const Both both = broken(cases()[1]);
  int asked = 0, last = 1 << 30;
  const Progress progress{.report = {}, .cancelled = [&] { return ++asked > last; }};
  const FragmentPointOptions options{{.count = 10}, nullptr, both.ready.surface};
  (void)samplePoints(both.bare.solid, both.bare.labels, options, &progress);
  const int all = asked;
  EXPECT_GT(all, 10);
  for (const int stop : {0, all / 4, all / 2, 3 * all / 4, all - 1}) {
    asked = 0;
    last = stop;
    try {
      (void)samplePoints(both.bare.solid, both.bare.labels, options, &progress);
      ADD_FAILURE() << "not stopped at question " << stop;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
  }
}

}  // namespace
}  // namespace sherd
