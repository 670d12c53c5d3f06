// Solids from meshes of every kind.
#include "voxelize/fill/fill.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/fragments.h>
#include <sherd/solid.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/random.h"
#include "mesh/repair/repair.h"
#include "mesh/search/triangle_tree.h"
#include "mesh/search/winding_number.h"
#include "seed/draw/samplers.h"
#include "shapes.h"
#include "voxelize/band.h"
#include "voxelize/canonical_solid.h"
#include "voxelize/distance.h"
#include "voxelize/fill/caps.h"
#include "voxelize/fill/exposed.h"
#include "voxelize/fill/holes.h"

namespace sherd {
namespace {

constexpr double kPi = std::numbers::pi;

glm::dvec3 randomPoint(std::mt19937& random, double extent) {
  std::uniform_real_distribution<double> uniform(-extent, extent);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

TriangleMesh turned(TriangleMesh mesh, double angle, const glm::dvec3& offset) {
  const double c = std::cos(angle), s = std::sin(angle);
  const glm::dmat3 about(c, s, 0, -s, c, 0, 0, 0, 1), across(1, 0, 0, 0, c, s, 0, -s, c);
  for (glm::dvec3& v : mesh.vertices) v = across * (about * v) + offset;
  return mesh;
}

// Triangles for which `dropped` says so of their middle are left out.
TriangleMesh without(TriangleMesh mesh, const std::function<bool(glm::dvec3)>& dropped) {
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
    return dropped((mesh.vertices[t.x] + mesh.vertices[t.y] + mesh.vertices[t.z]) / 3.0);
  });
  return mesh;
}

using Voxels = std::set<std::tuple<int, int, int>>;

Voxels voxelsOf(const Solid& solid) {
  Voxels voxels;
  solid.blocks->forEachInside([&](std::size_t voxelIndex) {
    const openvdb::Coord v = solid.blocks->voxelAt(voxelIndex);
    voxels.emplace(v.x(), v.y(), v.z());
  });
  return voxels;
}

double volumeOf(const Solid& solid) {
  return static_cast<double>(solid.voxels) * std::pow(solid.frame.voxelSize, 3);
}

// ---- The tree

TEST(TriangleTree, FindsTheNearestTriangleAsALookAtAllOfThemDoes) {
  const TriangleMesh mesh = shapes::torus(10.0, 4.0, 40, 20);
  const TriangleTree tree(mesh);
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 p = randomPoint(random, 16.0);
    double least = INFINITY;
    for (const glm::uvec3& t : mesh.triangles) {
      const TriangleMesh one{{mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]},
                             {{0, 1, 2}}};
      least = std::min(least, TriangleTree(one).nearest(p, INFINITY).distance);
    }
    EXPECT_EQ(tree.nearest(p, INFINITY).distance, least);
    const auto near = tree.nearest(p, 2.0);
    EXPECT_EQ(near.triangle == TriangleTree::kNone, least >= 2.0);
    EXPECT_EQ(tree.nearest(p, INFINITY, 17).distance, least) << "a bad guess changes nothing";
  }
  EXPECT_EQ(TriangleTree({}).nearest({0, 0, 0}, INFINITY).triangle, TriangleTree::kNone);
}

TEST(TriangleTree, BoxesMeetATouchedBoxAndNoneBeside) {
  const glm::dvec3 far(0x1p40, -0x1p40, 0.1);  // where single precision is coarse
  TriangleMesh mesh = shapes::torus(10.0, 4.0, 20, 12);
  for (glm::dvec3& v : mesh.vertices) v += far;
  const TriangleTree tree(mesh);
  std::mt19937 random(8);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 a = far + randomPoint(random, 14.0), b = far + randomPoint(random, 14.0);
    Box box{glm::min(a, b), glm::max(a, b)};
    if (i % 2 == 0) box.max = box.min + 0.5;
    if (i % 5 == 0) box.min = box.max = mesh.vertices[static_cast<std::size_t>(i)];
    std::size_t expected = 0;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 &p = mesh.vertices[t.x], &q = mesh.vertices[t.y], &r = mesh.vertices[t.z];
      const glm::dvec3 low = glm::min(p, glm::min(q, r)), high = glm::max(p, glm::max(q, r));
      bool isApart = false;
      for (int k = 0; k < 3; ++k) isApart |= low[k] > box.max[k] || high[k] < box.min[k];
      expected += isApart ? 0 : 1;
    }
    EXPECT_EQ(tree.meeting(box).size(), expected);
    EXPECT_EQ(tree.isAnyMeeting(box), expected > 0);
  }
}

TEST(TriangleTree, WindsAsTheSumOfAllSolidAnglesDoes) {
  const TriangleMesh mesh =
      without(shapes::ball(10.0, 4), [](const glm::dvec3& p) { return p.z > 8.0; });
  const TriangleTree tree(mesh);
  std::mt19937 random(6);
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 p = randomPoint(random, 14.0);
    EXPECT_NEAR(tree.winding(p), windingNumber(mesh, p), 0.03) << p.x << " " << p.y << " " << p.z;
  }
}

TEST(TriangleTree, StepsGoInAsOftenAsTheWindingNumberRises) {
  const TriangleMesh mesh = shapes::append(shapes::cube(9.0), shapes::ball(5.0, 3, {4, 1, 0}));
  const TriangleTree tree(mesh);
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    // From lattice points, which lie in the cube's planes and on its edges' lines.
    const glm::dvec3 from = glm::round(randomPoint(random, 8.0)), to = randomPoint(random, 8.0);
    EXPECT_EQ(tree.entries(from, to),
              std::lround(windingNumber(mesh, to)) - std::lround(windingNumber(mesh, from)));
    glm::dvec3 beside = from;
    beside[i % 3] = to[i % 3];  // along an axis, through what may be flat boxes
    EXPECT_EQ(
        tree.entries(from, beside),
        tree.entries(from, beside, tree.meeting({glm::min(from, beside), glm::max(from, beside)})));
  }
}

TEST(Band, HoldsEveryVoxelNearTheSurfaceAndItsDistance) {
  const double radius = 9.3;
  const TriangleMesh mesh = shapes::ball(radius, 5);
  const auto band = bandOf(TriangleTree(mesh), 3.0, nullptr);
  std::size_t near = 0, expected = 0;
  for (const BandLeaf& leaf : band) {
    for (std::uint32_t offset = 0; offset < 512; ++offset) {
      if (!std::isfinite(leaf.distance[offset])) continue;
      ++near;
      const openvdb::Coord v = leaf.origin + coordFromOffset(offset);
      const double r = std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z());
      // The polyhedron lies up to this far within the ball: 1 - cos of half an edge's angle.
      EXPECT_NEAR(leaf.distance[offset], std::abs(r - radius), radius * 0.0008);
    }
  }
  for (int x = -14; x <= 14; ++x) {
    for (int y = -14; y <= 14; ++y) {
      for (int z = -14; z <= 14; ++z) {
        expected += std::abs(std::sqrt(x * x + y * y + z * z) - radius) < 2.99 ? 1u : 0u;
      }
    }
  }
  EXPECT_GE(near, expected);
}

TEST(Band, HasTheDistanceOfTheNearestTriangleToTheBit) {
  std::mt19937 random(11);
  TriangleMesh needles, flat;  // long, thin and large ones; some without area
  for (std::uint32_t i = 0; i < 60; ++i) {
    const glm::dvec3 from = randomPoint(random, 20.0);
    const glm::dvec3 along = randomPoint(random, i % 3 == 0 ? 40.0 : 2.0);
    const glm::dvec3 beside = i % 5 == 0 ? 0.5 * along : randomPoint(random, 0.1);
    for (const glm::dvec3& v : {from, from + along, from + beside}) needles.vertices.push_back(v);
    needles.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  flat = shapes::cube(20.0);
  for (glm::dvec3& v : flat.vertices) v.z = std::round(0.1 * v.z);  // two walls through voxels
  // The last has more triangles in a leaf than are put into a list.
  for (const TriangleMesh& mesh :
       {needles, flat, shapes::torus(9.0, 3.0, 30, 12), shapes::ball(4.0, 6)}) {
    const TriangleTree tree(mesh);
    std::size_t near = 0, expected = 0;
    for (const BandLeaf& leaf : bandOf(tree, 3.0, nullptr)) {
      for (std::uint32_t offset = 0; offset < 512; ++offset) {
        const openvdb::Coord v = leaf.origin + coordFromOffset(offset);
        const double found = tree.nearest({v.x(), v.y(), v.z()}, 3.0).distance;
        EXPECT_EQ(leaf.distance[offset], static_cast<float>(found));
        near += std::isfinite(found) ? 1u : 0u;
      }
    }
    for (int x = -64; x < 64; ++x) {
      for (int y = -64; y < 64; ++y) {
        for (int z = -64; z < 64; ++z) {
          expected += std::isfinite(tree.nearest({x, y, z}, 3.0).distance) ? 1u : 0u;
        }
      }
    }
    EXPECT_EQ(near, expected);
    EXPECT_GT(near, 0u);
  }
}

// ---- Rules of filling

// Where the centers of a box of voxels do not lie on the same side by all three rules, how far they
// are from the surface.
double farthestDisagreement(const TriangleMesh& source, int resolution, std::size_t& inside) {
  const double voxelSize = voxelSizeFor(source, {.resolution = resolution});
  TriangleMesh mesh = source;
  const glm::dvec3 corner = bounds(source).min + 0.5 * voxelSize;
  for (glm::dvec3& v : mesh.vertices) v = (v - corner) / voxelSize;
  const SearchedMesh whole = searched(repaired(mesh).mesh);
  const auto filled = [&](Fill fill) {
    const SolidOptions options{.resolution = resolution, .fill = fill};
    return fillingOf(chosenFill(whole, options), whole, mesh, options, voxelSize);
  };
  const Filling winding = filled(Fill::winding), parity = filled(Fill::parity),
                flood = filled(Fill::flood);
  const TriangleTree tree(mesh);
  double farthest = 0.0;
  inside = 0;
  const Box box = bounds(mesh);
  for (int x = -2; x <= static_cast<int>(box.max.x) + 2; ++x) {
    for (int y = -2; y <= static_cast<int>(box.max.y) + 2; ++y) {
      for (int z = -2; z <= static_cast<int>(box.max.z) + 2; ++z) {
        const openvdb::Coord voxel(x, y, z);
        const bool isInside = winding.isInside(voxel);
        inside += isInside ? 1 : 0;
        if (isInside != parity.isInside(voxel) || isInside != flood.isInside(voxel)) {
          farthest = std::max(farthest, tree.nearest(glm::dvec3(x, y, z), INFINITY).distance);
        }
      }
    }
  }
  return farthest;
}

TEST(Fill, WindingParityAndFloodAgreeOnCleanMeshes) {
  const std::pair<const char*, TriangleMesh> all[] = {
      {"ball", shapes::ball(1.0, 4)},
      {"torus", shapes::torus(1.0, 0.35)},
      {"cube", shapes::cube(1.0)},
      {"cup", shapes::cup(1.0, 0.1, 1.6, 0.15)},
      {"hollow ball", shapes::hollowBall(1.0, 0.7)},
      {"two balls apart", shapes::append(shapes::ball(1.0), shapes::ball(0.5, 4, {2, 0, 0}))}};
  for (const auto& [name, mesh] : all) {
    for (const double angle : {0.0, 0.4, 2.0}) {
      std::size_t inside = 0;
      EXPECT_LT(farthestDisagreement(turned(mesh, angle, {3.1, -40.7, 5e3}), 64, inside), 1e-6)
          << name << " turned by " << angle;
      EXPECT_GT(inside, 1000u);
    }
  }
}

// Two boxes with one wall between them: its four edges have three faces each, and nothing is open.
TEST(Fill, AWallWithinIsNotCalledOpen) {
  TriangleMesh mesh;
  for (const double x : {0.0, 1.0, 2.0}) {
    for (const double y : {0.0, 1.0}) {
      for (const double z : {0.0, 1.0}) mesh.vertices.emplace_back(x, y, z);
    }
  }
  const auto quad = [&](unsigned a, unsigned b, unsigned c, unsigned d) {
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
  };
  for (const unsigned v : {0u, 4u}) {  // of each box: y = 0 and 1, z = 0 and 1
    quad(v, v + 4, v + 5, v + 1);
    quad(v + 2, v + 3, v + 7, v + 6);
    quad(v, v + 2, v + 6, v + 4);
    quad(v + 1, v + 5, v + 7, v + 3);
  }
  quad(0, 1, 3, 2);
  quad(8, 10, 11, 9);
  EXPECT_EQ(chosenFill(searched(mesh), {}).reason, "the mesh is closed");
  quad(4, 5, 7, 6);
  EXPECT_EQ(chosenFill(searched(mesh), {}).reason,
            "the mesh has 4 non-manifold edges; it is filled where the winding number is 0.5");
  mesh.triangles.pop_back();
  EXPECT_EQ(chosenFill(searched(mesh), {}).reason,
            "the mesh is open; its holes are closed where the winding number is 0.5");
}

TEST(Fill, RulesAgreeOnRealMeshes) {
  const char* folder = std::getenv("SHERD_TEST_DATA");
  if (folder == nullptr) GTEST_SKIP() << "SHERD_TEST_DATA names no folder of meshes";
  for (const char* name : {"bunny.off", "1002_tray_bottom.STL", "springer.obj", "boot.obj"}) {
    const SourceMesh source = readMesh(std::filesystem::path(folder) / name);
    std::size_t inside = 0;
    EXPECT_LT(farthestDisagreement(source.mesh, 96, inside), 1e-6) << name;
    EXPECT_GT(inside, 1000u) << name;
  }
}

TEST(Fill, TheWayTrianglesAreTurnedDoesNotMatter) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  TriangleMesh mixed = ball;
  for (std::size_t i = 0; i < mixed.triangles.size(); i += 3) {
    std::swap(mixed.triangles[i].y, mixed.triangles[i].z);
  }
  const Solid whole = voxelize(ball, {.resolution = 32}),
              solid = voxelize(mixed, {.resolution = 32});
  EXPECT_EQ(voxelsOf(solid), voxelsOf(whole));
  EXPECT_GT(solid.report.defects.misorientedEdges, 0u);
  EXPECT_EQ(solid.report.defects.flippedTriangles, (ball.triangles.size() + 2) / 3);
  const Solid inside = voxelize(shapes::inverted(ball), {.resolution = 32});
  EXPECT_EQ(voxelsOf(inside), voxelsOf(whole));
  EXPECT_EQ(inside.report.defects.flippedComponents, 1u);
}

TEST(Fill, AComponentThatIsInsideOutIsTurnedButACavityIsNot) {
  const TriangleMesh big = shapes::ball(1.0, 3);
  const TriangleMesh apart = shapes::ball(0.4, 3, {2.0, 0, 0}), within = shapes::ball(0.4, 3);
  const Solid two = voxelize(shapes::append(big, apart), {.resolution = 64});
  const Solid other = voxelize(shapes::append(big, shapes::inverted(apart)), {.resolution = 64});
  EXPECT_EQ(voxelsOf(two), voxelsOf(other));
  EXPECT_EQ(other.report.defects.flippedComponents, 1u);
  const Solid hollow = voxelize(shapes::append(big, shapes::inverted(within)), {.resolution = 64});
  EXPECT_EQ(hollow.report.defects.flippedComponents, 0u);
  EXPECT_NEAR(volumeOf(hollow), volume(big) - volume(within), 0.01);
}

TEST(Fill, DoubledTrianglesCountOnce) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  TriangleMesh doubled = ball;
  for (std::size_t i = 0; i < ball.triangles.size(); i += 5) {
    const glm::uvec3 t = ball.triangles[i];
    doubled.triangles.emplace_back(t.y, t.z, t.x);
  }
  const Solid solid = voxelize(doubled, {.resolution = 32});
  EXPECT_EQ(voxelsOf(solid), voxelsOf(voxelize(ball, {.resolution = 32})));
  EXPECT_EQ(solid.report.defects.duplicateTriangles, (ball.triangles.size() + 4) / 5);
  EXPECT_GT(solid.report.defects.nonManifoldEdges, 0u);
}

// Every face from both sides, as some programs export all of a model.
TEST(Fill, ASurfaceWithBothSidesIsSolid) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  TriangleMesh both = ball;
  for (const glm::uvec3& t : ball.triangles) both.triangles.emplace_back(t.z, t.y, t.x);
  TriangleMesh mixed = both;  // either side first
  for (std::size_t i = 0; i < ball.triangles.size(); i += 3) {
    std::swap(mixed.triangles[i], mixed.triangles[i + ball.triangles.size()]);
  }
  for (const TriangleMesh& mesh : {both, mixed}) {
    const Solid solid = voxelize(mesh, {.resolution = 32});
    EXPECT_EQ(voxelsOf(solid), voxelsOf(voxelize(ball, {.resolution = 32})));
    EXPECT_EQ(solid.report.fill, Fill::winding);
    EXPECT_EQ(solid.report.defects.duplicateTriangles, ball.triangles.size());
    EXPECT_EQ(solid.report.defects.sheetTriangles, 0u);
  }
}

TEST(Fill, AWallBetweenBodiesIsNoSheet) {
  // Two cubes with the corners of their common face, which both have.
  const TriangleMesh cube = shapes::cube(1.0);
  TriangleMesh both = shapes::append(cube, shapes::transformed(cube, 1.0, {1.0, 0.0, 0.0}));
  std::map<std::tuple<double, double, double>, std::uint32_t> at;
  std::vector<std::uint32_t> number;
  for (const glm::dvec3& v : both.vertices) {
    number.push_back(
        at.try_emplace({v.x, v.y, v.z}, static_cast<std::uint32_t>(number.size())).first->second);
  }
  for (glm::uvec3& t : both.triangles) t = {number[t.x], number[t.y], number[t.z]};
  const Solid solid = voxelize(both, {.voxelSize = 0.1});
  EXPECT_EQ(solid.report.defects.sheetTriangles, 0u);
  EXPECT_NEAR(volumeOf(solid), 2.0, 0.02);
}

// Two tetrahedra on the same side of a triangle, which both have: without its copy neither would be
// closed.
TEST(Fill, ATriangleOfTwoBodiesOnOneSideCountsForBoth) {
  const TriangleMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.5, 0.2, 0.9}},
                         {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  TriangleMesh other = one;
  other.vertices[3] = {0.8, 0.5, 0.7};
  TriangleMesh both = one;
  both.vertices.push_back(other.vertices[3]);
  both.triangles.insert(both.triangles.end(), {{0, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 0, 4}});
  const SolidOptions options{.voxelSize = 1.0 / 32.0};
  const Solid solid = voxelize(both, options);
  EXPECT_EQ(solid.report.fill, Fill::winding);
  EXPECT_EQ(solid.report.defects.duplicateTriangles, 0u);
  Voxels expected;
  for (const TriangleMesh& mesh : {one, other}) {
    TriangleMesh alone = mesh;  // in the same grid
    alone.vertices.push_back(both.vertices[mesh.vertices == one.vertices ? 4 : 3]);
    expected.merge(voxelsOf(voxelize(alone, options)));
  }
  EXPECT_EQ(voxelsOf(solid), expected);
}

TEST(Fill, AWallBetweenTwoBodiesThatTouchIsNone) {
  // Two boxes side by side, each with its own copy of the square between them.
  TriangleMesh boxes = shapes::append(shapes::cube(1.0), shapes::cube(1.0, {1.0, 0, 0}));
  const Solid solid = voxelize(boxes, {.voxelSize = 1.0 / 16.0});
  EXPECT_EQ(solid.voxels, 16u * 16 * 32);
}

// ---- Holes

TEST(Fill, AHoleIsClosedNearlyFlat) {
  const double radius = 1.0, height = 0.9;
  const TriangleMesh open =
      without(shapes::ball(radius, 5), [&](const glm::dvec3& p) { return p.z > height; });
  const Solid solid = voxelize(open, {.voxelSize = 1.0 / 40.0});
  EXPECT_EQ(solid.report.fill, Fill::winding);
  EXPECT_GT(solid.report.defects.boundaryEdges, 20u);
  // Between the ball cut flat and the whole one, some way bulged: the winding number goes on.
  const double cap = kPi * std::pow(radius - height, 2) * (3 * radius - (radius - height)) / 3;
  const double whole = shapes::ballVolume(radius);
  EXPECT_GT(volumeOf(solid), whole - 1.1 * cap);
  EXPECT_LT(volumeOf(solid), whole);
}

TEST(Fill, TheVolumeOfAnOpenMeshIsThatOfTheClosedOne) {
  TriangleMesh box = shapes::cube(1.0, {4.0, -7.0, 2.0});
  const double top = bounds(box).max.z;
  std::erase_if(box.triangles, [&](const glm::uvec3& t) {
    return box.vertices[t.x].z == top && box.vertices[t.y].z == top && box.vertices[t.z].z == top;
  });
  ASSERT_EQ(box.triangles.size(), 10u);
  EXPECT_NEAR(voxelize(box, {.resolution = 16}).report.meshVolume, 1.0, 1e-9);
}

TEST(Fill, OneMissingTriangleChangesNothing) {
  TriangleMesh open = shapes::ball(1.0, 4);
  const TriangleMesh ball = open;
  open.triangles.erase(open.triangles.begin() + 700);
  const Voxels whole = voxelsOf(voxelize(ball, {.resolution = 48}));
  const Voxels solid = voxelsOf(voxelize(open, {.resolution = 48}));
  Voxels apart;
  std::set_symmetric_difference(whole.begin(), whole.end(), solid.begin(), solid.end(),
                                std::inserter(apart, apart.begin()));
  EXPECT_LE(apart.size(), 1u);
}

TEST(Fill, WhereAnOpenMeshHasASurfaceItIsAsExactAsAClosedOnes) {
  const double radius = 1.0, h = 1.0 / 40.0;
  const TriangleMesh ball = shapes::ball(radius, 5);
  const TriangleMesh open = without(ball, [&](const glm::dvec3& p) { return p.z > 0.8; });
  const Solid closed = voxelize(ball, {.voxelSize = h}), holed = voxelize(open, {.voxelSize = h});
  // Below the hole's rim by more than the band both have the same voxels, each with its distance.
  const auto below = [&](const Solid& solid) {
    Voxels voxels;
    for (const auto& v : voxelsOf(solid)) {
      const auto [x, y, z] = v;
      const glm::dvec3 at = solid.frame.worldFromIndex(glm::dvec3(x, y, z));
      if (at.z < 0.8 - 4 * h)
        voxels.emplace(std::lround(at.x / h * 2), std::lround(at.y / h * 2),
                       std::lround(at.z / h * 2));
    }
    return voxels;
  };
  EXPECT_EQ(below(holed), below(closed));
}

TEST(Fill, TheSolidMovesWithTheMesh) {
  const TriangleMesh open =
      without(shapes::ball(1.0, 4), [](const glm::dvec3& p) { return p.z > 0.9; });
  const Solid here = voxelize(open, {.resolution = 96});
  const Solid there = voxelize(shapes::transformed(open, 4.0, {0, 0, 0}), {.resolution = 96});
  EXPECT_EQ(voxelsOf(here), voxelsOf(there));
  const double h = here.frame.voxelSize;
  for (const double angle : {0.3, 1.1}) {
    const Solid other = voxelize(turned(open, angle, {10, 20, 30}), {.voxelSize = h});
    EXPECT_NEAR(volumeOf(other) / volumeOf(here), 1.0, 0.003);
  }
}

// ---- Overlaps

TEST(Fill, OverlapsUniteWithExactDistancesOutside) {
  const double h = 1.0 / 24.0;
  const glm::dvec3 a(0.0), b(0.9, 0.2, 0.1);
  const TriangleMesh mesh = shapes::append(shapes::ball(1.0, 5, a), shapes::ball(0.7, 5, b));
  const Solid solid = voxelize(mesh, {.voxelSize = h});
  const double apart = glm::length(b - a), R = 1.0, r = 0.7;
  const double lens =
      kPi * std::pow(R + r - apart, 2) *
      (apart * apart + 2 * apart * r - 3 * r * r + 2 * apart * R + 6 * r * R - 3 * R * R) /
      (12 * apart);
  EXPECT_NEAR(volumeOf(solid), shapes::ballVolume(R) + shapes::ballVolume(r) - lens, 0.012);
  solid.blocks->forEachInside([&](std::size_t voxelIndex) {
    const openvdb::Coord v = solid.blocks->voxelAt(voxelIndex);
    const glm::dvec3 p = solid.frame.worldFromIndex(v);
    EXPECT_LT(std::min(glm::length(p - a) - R, glm::length(p - b) - r), 1e-9);
  });
}

TEST(Fill, LargeTrianglesThatCrossAreCutWhereTheyDo) {
  // Three bars through each other, of twelve triangles each, turned.
  const auto bar = [](const glm::dvec3& half) {
    TriangleMesh mesh = shapes::cube(2.0);
    for (glm::dvec3& v : mesh.vertices) v *= half;
    return mesh;
  };
  const glm::dvec3 halves[] = {{20.3, 3.1, 3.3}, {3.2, 19.7, 2.9}, {2.8, 3.4, 21.1}};
  TriangleMesh all = bar(halves[0]);
  for (int k = 1; k < 3; ++k) all = shapes::append(all, bar(halves[k]));
  const double angle = 0.4;
  const SearchedMesh mesh = searched(turned(all, angle, {0.0, 0.0, 0.0}));
  const Filling filling = fillingOf(chosenFill(mesh, {}), mesh, mesh.mesh, {}, 1.0);
  const double c = std::cos(angle), s = std::sin(angle);
  const glm::dmat3 about(c, s, 0, -s, c, 0, 0, 0, 1), across(1, 0, 0, 0, c, s, 0, -s, c);
  std::mt19937 random(9);
  std::size_t near = 0, deep = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 p = randomPoint(random, 12.0);
    double least = INFINITY, deepest = 0.0;
    for (const glm::dvec3& half : halves) {
      const glm::dvec3 beyond = glm::abs(p) - half;
      least = std::min(least, glm::length(glm::max(beyond, 0.0)));
      deepest = std::max(deepest, -std::max({beyond.x, beyond.y, beyond.z}));
    }
    const double found = filling.surface->nearest(across * (about * p), INFINITY).distance;
    if (least > 0.0) {
      EXPECT_NEAR(found, least, 1e-9);
    } else {
      EXPECT_GT(found, deepest - 0.3);  // what is left within the solid is a piece at its rim
    }
    near += least > 0.0 && least < 3.0;
    deep += deepest > 2.0;
  }
  EXPECT_GT(near, 3000u);
  EXPECT_GT(deep, 300u);
}

TEST(Fill, FacesThroughVoxelCentersLeaveWhatIsBetweenThem) {
  // A cube two voxels wide: one center within, those beside it on its faces.
  const TriangleMesh mesh =
      shapes::append(shapes::cube(16.0, {8.0, 8.0, 8.0}), shapes::cube(2.0, {20.5, 8.5, 8.5}));
  const Solid solid = voxelize(mesh, {.voxelSize = 1.0});
  const Voxels voxels = voxelsOf(solid);
  EXPECT_TRUE(voxels.contains({20, 8, 8}));
  EXPECT_FALSE(voxels.contains({22, 8, 8}));
  EXPECT_GE(voxels.size(), 16u * 16 * 16 + 1);
}

// As grids of other programs have it, and where a hole is far from any triangle.  Surfaces were
// looked for in leaves that were not there.
TEST(Fill, InsideVoxelsHaveLeavesAllRoundThem) {
  const auto grid = uniformGrid(3.0f);
  grid->tree().sparseFill(openvdb::CoordBBox({0, 0, 0}, {7, 7, 7}), -3.0f, /*active=*/false);
  const LeafBlocks blocks = leafBlocks(*grid);
  EXPECT_EQ(blocks.insideVoxels(), 512u);
  EXPECT_EQ(blocks.count(), 27u);
}

TEST(Fill, LeavesRoundTheInsideAreNotComponentOfAFragment) {
  const auto grid = uniformGrid(3.0f);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->tree().sparseFill(openvdb::CoordBBox({0, 0, 0}, {15, 15, 15}), -3.0f, /*active=*/false);
  const Solid solid = solidOf(*grid);
  Labels labels{.blocks = solid.blocks, .fragmentCount = 2};
  labels.fragment.assign(solid.blocks->count() * std::size_t{512}, 0);
  solid.blocks->forEachInside([&](std::size_t voxelIndex) {
    labels.fragment[voxelIndex] = solid.blocks->voxelAt(voxelIndex).x() < 6 ? 1 : 2;
  });
  const std::vector<Fragment> made = extractFragments(solid, labels);
  ASSERT_EQ(made.size(), 2u);
  openvdb::Index64 inside = 0;
  for (const Fragment& fragment : made) {
    ASSERT_NE(fragment.surface, nullptr);
    for (auto value = fragment.surface->cbeginValueAll(); value; ++value) {
      if (*value < 0.0f) inside += value.getVoxelCount();
    }
  }
  EXPECT_EQ(inside, 16u * 16 * 16);
}

// A box whose sides x = 0 and x = 10 have square openings, `gap` wider all round than 0..8 is.
TriangleMesh boxWithTwoOpenings(double gap) {
  TriangleMesh mesh;
  for (const double x : {0.0, 10.0}) {
    for (const auto& [low, high] : {std::pair{-6.0, 14.0}, std::pair{-gap, 8.0 + gap}}) {
      mesh.vertices.insert(mesh.vertices.end(),
                           {{x, low, low}, {x, high, low}, {x, high, high}, {x, low, high}});
    }
  }
  const auto addQuad = [&](unsigned i, unsigned j, unsigned k, unsigned l) {
    mesh.triangles.emplace_back(i, j, k);
    mesh.triangles.emplace_back(i, k, l);
  };
  for (unsigned k = 0; k < 4; ++k) {
    const unsigned next = (k + 1) % 4;
    addQuad(k, 4 + k, 4 + next, next);
    addQuad(8 + k, 8 + next, 12 + next, 12 + k);
    addQuad(k, next, 8 + next, 8 + k);
  }
  return mesh;
}

// Steps from a voxel to the next whose ends lie on different sides, and those of them that the
// surface does not pass.
std::pair<int, int> stepsThrough(const TriangleMesh& whole) {
  const SearchedMesh mesh = searched(repaired(whole).mesh);
  const Filling filling =
      fillingOf({Fill::winding, ""}, mesh, mesh.mesh, {.fill = Fill::winding}, 1.0);
  const Box box = bounds(mesh.mesh);
  int steps = 0, leaks = 0;
  for (int x = static_cast<int>(box.min.x) - 2; x <= box.max.x + 1; ++x) {
    for (int y = static_cast<int>(box.min.y) - 2; y <= box.max.y + 1; ++y) {
      for (int z = static_cast<int>(box.min.z) - 2; z <= box.max.z + 1; ++z) {
        const openvdb::Coord from(x, y, z);
        for (int axis = 0; axis < 3; ++axis) {
          openvdb::Coord to = from;
          ++to[axis];
          if (filling.isInside(from) == filling.isInside(to)) continue;
          const glm::dvec3 middle =
              0.5 * (glm::dvec3(x, y, z) + glm::dvec3(to.x(), to.y(), to.z()));
          ++steps;
          leaks += filling.surface->nearest(middle, 1.0).triangle == TriangleTree::kNone;
        }
      }
    }
  }
  return {steps, leaks};
}

// A missing piece of the surface let the inside flow out, up to the next 128 voxels' end.
TEST(Fill, ABeamThroughOpeningsThatFitItTightlyHasItsSurface) {
  std::mt19937 random(5);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int k = 0; k < 60; ++k) {
    const double from = between(-120.0, -20.0), to = between(11.0, 40.0),
                 gap = std::pow(10.0, between(-2.3, -0.3));
    TriangleMesh beam = shapes::cube(8.0, {4.0, 4.0, 4.0});
    for (glm::dvec3& v : beam.vertices) v.x = v.x > 0.0 ? to : from;
    const glm::dvec3 shift(between(0, 1), between(0, 1), between(0, 1));
    const auto [steps, leaks] = stepsThrough(
        shapes::transformed(shapes::append(boxWithTwoOpenings(gap), beam), 1.0, shift));
    EXPECT_GT(steps, 2000);
    EXPECT_EQ(leaks, 0) << k << " " << from << " " << to << " " << gap;
  }
}

TEST(Fill, ChangesOfSideInRealMeshesHaveASurface) {
  const char* folder = std::getenv("SHERD_TEST_DATA");
  if (folder == nullptr) GTEST_SKIP() << "SHERD_TEST_DATA names no folder of meshes";
  const std::tuple<const char*, double> files[] = {
      {"Lantern.gltf", 200.0}, {"spider.obj", 90.0}, {"openscad-nonmanifold-crash.obj", 224.0}};
  for (const auto& [name, side] : files) {
    const TriangleMesh mesh = readMesh(std::filesystem::path(folder) / name).mesh;
    const double scale = side / longestSide(bounds(mesh));
    const glm::dvec3 corner = scale * bounds(mesh).min;
    const auto [steps, leaks] = stepsThrough(shapes::transformed(mesh, scale, -corner - 0.5));
    EXPECT_GT(steps, 5000) << name;
    EXPECT_EQ(leaks, 0) << name;
  }
}

// Where faces pass exactly through centers of voxels, steps from these began on either side: parts
// of the surface were missing, and the inside took all memory.
TEST(Fill, BodiesThatCrossMayHaveFacesAtTheCentersOfVoxels) {
  for (const double rounding : {0.0, 0x1p-24}) {  // as of single precision
    for (const int resolution : {20, 50, 98, 100}) {
      const double h = 2.0 / resolution, t = std::max(4.0, resolution / 20.0) * h / 2.0;
      TriangleMesh cross =
          shapes::append(shapes::box({2.0, 1.0, 2.0 * t}), shapes::box({2.0 * t, 1.0, 2.0}));
      for (glm::dvec3& v : cross.vertices) v *= 1.0 + rounding;
      const SearchedMesh mesh =
          searched(shapes::transformed(cross, 1.0 / h, glm::dvec3(1.0, 0.5, 1.0) / h - 0.5));
      const auto [steps, leaks] = stepsThrough(mesh.mesh);
      EXPECT_GT(steps, 1000) << resolution;
      EXPECT_EQ(leaks, 0) << resolution << " " << rounding;
    }
  }
}

// The same faces, which rounding puts above or below the centers where the size of voxels is no
// power of two.
TEST(Fill, FacesAtCentersUpToRoundingAreOnOneSide) {
  const auto boxFrom = [](const glm::dvec3& low, const glm::dvec3& high) {
    return shapes::transformed(shapes::box(high - low), 1.0, (low + high) / 2.0);
  };
  for (const int resolution : {24, 28, 36, 48, 72}) {
    const double unit = 1.0 / resolution;
    for (const double top : {3.5, 10.5, 11.5}) {
      const TriangleMesh low = boxFrom({0, 0, 0}, unit * glm::dvec3(resolution, 20, top));
      const TriangleMesh high =
          boxFrom(unit * glm::dvec3(3, 9, 1.5), unit * glm::dvec3(7, 17, 15.5));
      const Solid solid =
          voxelize(shapes::append(low, high), {.resolution = resolution, .keepMesh = false});
      const double common = 4.0 * 8.0 * (top - 1.5);
      const double exact = resolution * 20.0 * top + 4.0 * 8.0 * 14.0 - common;
      const double scale = std::pow(solid.frame.voxelSize / unit, 3);
      // Half a layer of voxels on two faces each way.
      EXPECT_NEAR(static_cast<double>(solid.voxels) * scale, exact,
                  0.51 * resolution * 20.0 + 0.51 * 2.0 * 32.0)
          << resolution << " " << top;
    }
  }
}

// ---- Shells

TEST(Fill, ASheetThatEnclosesNothingBecomesAShell) {
  const double side = 2.0, thickness = 0.2;
  TriangleMesh sheet{{{0, 0, 0}, {side, 0, 0.3}, {side, side, 0.3}, {0, side, 0}},
                     {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_NEAR(enclosure(searched(sheet)), 0.5, 0.01);
  const Solid solid = voxelize(sheet, {.voxelSize = 0.025, .shellThickness = thickness});
  EXPECT_EQ(solid.report.fill, Fill::shell);
  EXPECT_EQ(voxelize(sheet, {.resolution = 64}).report.fill, Fill::shell);
  const double slope = std::sqrt(side * side + 0.3 * 0.3);
  // A slab, half a rod along each edge, and a quarter of a ball at each corner.
  const double expected = side * slope * thickness +
                          (side + slope) * kPi * thickness * thickness / 4 +
                          kPi * std::pow(thickness, 3) / 6;
  EXPECT_NEAR(volumeOf(solid) / expected, 1.0, 0.01);
}

TEST(Fill, ABowlIsAShellAndABallWithASmallHoleIsNot) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const TriangleMesh bowl = without(ball, [](const glm::dvec3& p) { return p.z > 0.0; });
  EXPECT_NEAR(enclosure(searched(bowl)), 0.8, 0.02);
  EXPECT_EQ(voxelize(bowl, {.resolution = 64}).report.fill, Fill::shell);
  const TriangleMesh holed = without(ball, [](const glm::dvec3& p) { return p.z > 0.9; });
  EXPECT_EQ(voxelize(holed, {.resolution = 64}).report.fill, Fill::winding);
  EXPECT_EQ(voxelize(bowl, {.resolution = 64, .fill = Fill::winding}).report.fill, Fill::winding);
}

// ---- The report

TEST(Fill, WallsThinnerThanAVoxelAreReported) {
  const Solid solid = voxelize(shapes::cup(1.0, 0.02, 1.6, 0.2), {.resolution = 64});
  const WallThickness& walls = solid.report.walls;
  EXPECT_NEAR(walls.thinnest, 0.02 / solid.frame.voxelSize, 0.05);
  EXPECT_GT(walls.thinShare, 0.5);
  // The cup is 2 wide: its wall of 0.02 has a voxel and a half at 150.
  EXPECT_NEAR(walls.resolution, 150, 5);
  EXPECT_EQ(voxelize(shapes::ball(1.0), {.resolution = 32}).report.walls.resolution, 0);
}

TEST(Fill, AShellIsNoThickerThanTheMeshIsLong) {
  const TriangleMesh cube = shapes::cube(2.0);
  EXPECT_NO_THROW((void)voxelSizeFor(cube, {.resolution = 8, .shellThickness = 2.0}));
  for (const Fill fill : {Fill::parity, Fill::flood}) {  // none is made
    EXPECT_EQ(voxelSizeFor(cube, {.resolution = 8, .fill = fill, .shellThickness = 3.0}), 0.25);
  }
  for (const double thickness : {2.001, 1e9, double(INFINITY), double(NAN), -1.0}) {
    for (const Fill fill : {Fill::automatic, Fill::winding, Fill::shell}) {
      const SolidOptions options{.resolution = 8, .fill = fill, .shellThickness = thickness};
      try {
        (void)voxelize(cube, options);
        FAIL() << thickness;
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::usage);
        EXPECT_NE(std::string(e.what()).find("to 2,"), std::string::npos) << e.what();
      }
    }
  }
}

TEST(Caps, CloseWhatIsOpenAndNothingElse) {
  EXPECT_TRUE(loopCaps(shapes::torus(1.0, 0.3)).triangles.empty());
  EXPECT_TRUE(coneCaps(shapes::torus(1.0, 0.3)).triangles.empty());
  const TriangleMesh open =
      without(shapes::ball(1.0, 3), [](const glm::dvec3& p) { return std::abs(p.z) > 0.8; });
  const TriangleMesh caps = loopCaps(open);
  EXPECT_GT(caps.triangles.size(), 10u);
  // Far away the closed mesh's winding number is 0, so the caps' is the mesh's with a minus sign.
  const glm::dvec3 inside(0.1, 0.2, 0.0), outside(2.0, 0.3, 0.1);
  EXPECT_NEAR(windingNumber(open, inside) + windingNumber(caps, inside), 1.0, 1e-9);
  EXPECT_NEAR(windingNumber(open, outside) + windingNumber(caps, outside), 0.0, 1e-9);
}

TriangleMesh looseTriangles(std::uint64_t seed, std::size_t count, double size) {
  TriangleMesh mesh;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const glm::dvec3 middle = randomPoint(seed, Stage::pointPosition, 4 * i);
    for (std::uint64_t k = 1; k < 4; ++k) {
      mesh.vertices.push_back(middle +
                              size * (randomPoint(seed, Stage::pointPosition, 4 * i + k) - 0.5));
    }
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

// Behind triangles as large as their box winding numbers are far above 1 and below 0, and their
// mean is anything.
TEST(Fill, LooseTrianglesAreShells) {
  for (std::uint64_t seed = 1; seed < 40; ++seed) {
    for (const double size : {0.2, 1.0, 2.0}) {
      const SearchedMesh soup = searched(looseTriangles(seed, 60, size));
      EXPECT_EQ(chosenFill(soup, {}).fill, Fill::shell) << seed << ' ' << size;
    }
  }
}

TEST(Fill, EnclosureIsNoMoreThanThatOfAClosedMesh) {
  for (std::uint64_t seed = 1; seed < 10; ++seed) {
    EXPECT_LT(enclosure(searched(looseTriangles(seed, 60, 2.0))), 0.75) << seed;
  }
  EXPECT_GT(enclosure(searched(shapes::ball(1.0))), 0.97);
}

TEST(Fill, AnOpenMeshThatTakesTooLongIsAShell) {
  const TriangleMesh bowl =
      without(shapes::ball(1.0, 3), [](const glm::dvec3& p) { return p.z > 0.7; });
  for (const int resolution : {32, kAutoResolution}) {
    SolidOptions options;
    options.resolution = resolution;
    const Solid usual = voxelizeWithin(bowl, options, 1.0);
    EXPECT_EQ(usual.report.fill, Fill::winding);
    EXPECT_FALSE(usual.report.tookTooLong);
    const Solid late = voxelizeWithin(bowl, options, 1e-7);
    EXPECT_EQ(late.report.fill, Fill::shell);
    EXPECT_TRUE(late.report.tookTooLong);
    EXPECT_NE(late.report.fillReason.find("boundary edges"), std::string::npos);
    options.fill = Fill::winding;
    EXPECT_EQ(voxelizeWithin(bowl, options, 1e-7).report.fill, Fill::winding);
    options.fill = Fill::shell;
    EXPECT_EQ(late.voxels, voxelize(bowl, options).voxels);

    FractureResult result;
    result.solid = late;
    SourceMesh source;
    source.mesh = bowl;
    const std::vector<std::string> warnings = meshWarnings(source, result);
    EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(),
                            [](const std::string& warning) {
                              return warning.find("take too long; the fill winding") !=
                                     std::string::npos;
                            }),
              1);
  }
}

// A limit of work is one of the mesh and the resolution, whatever threads do it.
TEST(Fill, WorkIsCountedAlikeByAnyNumberOfThreads) {
  TriangleMesh boxes;
  for (std::uint64_t i = 0; i < 6; ++i) {
    TriangleMesh box = shapes::cube(5.0, 5.0 * randomPoint(3, Stage::pointPosition, i));
    box.triangles.resize(10);
    boxes = shapes::append(boxes, box);
  }
  const SearchedMesh mesh = searched(boxes);
  ASSERT_FALSE(mesh.caps.triangles.empty());
  // The steps of all work; nothing beyond `most`.
  const auto stepsOf = [&](std::uint64_t most, int threads) -> std::optional<std::uint64_t> {
    const GeneralizedWinding winding(mesh.mesh, mesh.caps, mesh.tree, nullptr, most);
    try {
      tbb::task_arena(threads).execute([&] {
        (void)exposedSurface(mesh.mesh, winding, nullptr);
        (void)holeSurface(winding, *mesh.tree, nullptr);
      });
    } catch (const TooMuchWork&) {
      return std::nullopt;
    }
    return winding.work().done();
  };
  const std::optional<std::uint64_t> all = stepsOf(std::uint64_t{1} << 40, 1);
  ASSERT_GT(all.value_or(0), 10000u);
  EXPECT_EQ(stepsOf(*all, 2), all);
  EXPECT_EQ(stepsOf(*all, 4), all);
  EXPECT_EQ(stepsOf(*all - 1, 1), std::nullopt);
  EXPECT_EQ(stepsOf(*all - 1, 4), std::nullopt);
}

}  // namespace
}  // namespace sherd
