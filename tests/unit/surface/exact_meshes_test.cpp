// Surface::exact: the input's own triangles, cut by the cracks.
#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/fracture.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "appearance/transfer.h"
#include "exact_checks.h"
#include "intersect/arrange/unite.h"
#include "intersect/self_crossings.h"
#include "mesh/positions.h"
#include "mesh/repair/repair.h"
#include "remesh/bodies.h"
#include "remesh/parts/part_edges.h"
#include "shapes.h"
#include "surface/exact/exact_surface.h"

namespace sherd {
namespace {

FractureOptions exactOptions(int pieces, int resolution, double roughness = 0.0) {
  FractureOptions options;
  options.pieces = pieces;
  options.seed = 7;
  options.solid.resolution = resolution;
  options.grow.roughness = roughness;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  return options;
}

FractureResult broken(const TriangleMesh& mesh, const FractureOptions& options) {
  Device device("builtin");
  return fracture(mesh, options, device);
}

void expectExact(const TriangleMesh& mesh, const FractureOptions& options) {
  const FractureResult result = broken(mesh, options);
  ASSERT_EQ(result.exactFailure, "");
  const ExactFaults faults =
      exactFaults(mesh, result.fragments, !options.erode.iterations.isZero());
  EXPECT_FALSE(faults.any()) << faults.text();
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(fragment.meshedAs, Surface::exact);
    EXPECT_NEAR(fragment.mass.volume, volume(fragment.mesh), 1e-12 * fragment.mass.volume);
  }
}

class ExactShapes : public ::testing::TestWithParam<std::pair<const char*, TriangleMesh>> {};

TEST_P(ExactShapes, FragmentsHaveTheInputsSurface) {
  const TriangleMesh& mesh = GetParam().second;
  for (const int pieces : {2, 12}) {
    for (const double roughness : {0.0, 2.0}) {
      SCOPED_TRACE(std::to_string(pieces) + " pieces, roughness " + std::to_string(roughness));
      expectExact(mesh, exactOptions(pieces, 40, roughness));
    }
  }
}

TEST_P(ExactShapes, OnePieceIsTheInput) {
  const TriangleMesh& mesh = GetParam().second;
  const FractureResult result = broken(mesh, exactOptions(1, 32));
  if (result.fragments.size() > 1) return;  // one for each part
  const TriangleMesh& whole = result.fragments.front().mesh;
  EXPECT_EQ(whole.vertices, mesh.vertices);
  EXPECT_EQ(whole.triangles, mesh.triangles);
}

INSTANTIATE_TEST_SUITE_P(
    Exact, ExactShapes,
    ::testing::Values(std::pair("cube", shapes::cube(2.0)), std::pair("ball", shapes::ball(1.0, 3)),
                      std::pair("torus", shapes::torus(2.0, 0.6, 48, 24)),
                      std::pair("cup", shapes::cup(1.0, 0.1, 1.5, 0.15, 40)),
                      std::pair("hollowBall", shapes::hollowBall(1.0, 0.7, 3)),
                      std::pair("twoParts", shapes::append(shapes::cube(1.0),
                                                           shapes::ball(0.6, 2, {2, 0, 0})))),
    [](const auto& shape) { return std::string(shape.param.first); });

TEST(Exact, PlanarCracksHaveFewTriangles) {
  const FractureResult result = broken(shapes::cube(2.0), exactOptions(2, 128));
  ASSERT_EQ(result.exactFailure, "");
  for (const Fragment& fragment : result.fragments) {
    const auto& neighbor = fragment.mesh.neighbor;
    const auto cracks =
        std::count_if(neighbor.begin(), neighbor.end(), [](int n) { return n > 0; });
    // One polygon, with a corner for each of the cube's triangles that it crosses, and those of the
    // crack's own border, which lies beyond the cube: some 130 triangles for 128 voxels a side.
    EXPECT_LT(cracks, 300);
  }
}

TEST(Exact, ErodedCracksKeepTheOuterSurface) {
  FractureOptions options = exactOptions(6, 64);
  options.erode.iterations = 2;
  expectExact(shapes::ball(1.0, 3), options);
  options.erode.on = ErodeOn::all;
  EXPECT_THROW((void)broken(shapes::ball(1.0, 3), options), Error);
}

TEST(Exact, IsNotSmoothed) {
  SurfaceOptions options{.surface = Surface::exact};
  EXPECT_NO_THROW(checkSurfaceOptions(options));
  options = {.surface = Surface::exact, .smooth = {.iterations = {1}}};
  EXPECT_THROW(checkSurfaceOptions(options), Error);
}

TEST(Exact, ASolidWithoutItsMeshFallsBack) {
  Device device("builtin");
  const FractureResult result =
      fracture(voxelize(shapes::cube(1.0), {.resolution = 32}), exactOptions(2, 32), device);
  EXPECT_EQ(result.exactFailure, "the solid has no input mesh");
}

// Checks the fragments of bodies that overlap or touch: each is one body, and together they are the
// union, of which volume and area are known.
void expectUnited(const TriangleMesh& mesh, const FractureOptions& options, std::size_t bodies,
                  double expectedVolume, double expectedArea) {
  const FractureResult result = broken(mesh, options);
  ASSERT_EQ(result.exactFailure, "");
  EXPECT_EQ(result.united.before, bodies);
  EXPECT_EQ(result.united.after, 1u);
  double sum = 0.0, outside = 0.0;
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(meshComponents(fragment.mesh).count, 1u);
    EXPECT_EQ(nonManifoldEdges(fragment.mesh), 0u);
    EXPECT_TRUE(selfCrossings(fragment.mesh.vertices, fragment.mesh.triangles).empty());
    sum += volume(fragment.mesh);
    TriangleMesh outer{fragment.mesh.vertices, {}};
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      if (fragment.mesh.neighborOf(t) == 0) outer.triangles.push_back(fragment.mesh.triangles[t]);
    }
    outside += area(outer);
  }
  EXPECT_NEAR(sum, expectedVolume, 1e-9 * expectedVolume);
  EXPECT_NEAR(outside, expectedArea, 1e-9 * expectedArea);
}

TriangleMesh brick(const glm::dvec3& low, const glm::dvec3& sides) {
  TriangleMesh box = shapes::box(sides);
  for (glm::dvec3& v : box.vertices) v += low + sides / 2.0;
  return box;
}

TEST(Exact, BodiesThatOverlapAreUnited) {
  const TriangleMesh cubes =
      shapes::append(shapes::cube(1.0), brick({0.0, -0.25, -0.25}, {1.0, 1.0, 1.0}));
  const double common = 0.5 * 0.75 * 0.75;
  for (const double roughness : {0.0, 1.5}) {
    expectUnited(cubes, exactOptions(6, 48, roughness), 2, 2.0 - common,
                 12.0 - 2.0 * (0.75 + 0.75 * 0.75));
  }
}

TEST(Exact, BricksThatTouchAreUnited) {
  TriangleMesh wall;
  for (int row = 0; row < 4; ++row) {
    for (int i = 0; i < 3; ++i) {
      wall = shapes::append(wall, brick({i + 0.5 * (row % 2), 0.0, 0.5 * row}, {1.0, 0.5, 0.5}));
    }
  }
  expectUnited(wall, exactOptions(12, 64), 12, 3.0,
               2 * 3.0 * 2.0 + 2 * 2.0 * 0.5 + 2 * 3.0 * 0.5 + 3 * 2 * 0.25);
}

// The voxels of both cubes are components of their own, and the rod has none.
TEST(Exact, FragmentsJoinedByLessThanAVoxelAreInThinContact) {
  const double side = 0.02, area = side * side;  // a third of a voxel
  TriangleMesh rod = shapes::transformed(shapes::box({1.0, side, side}), 1.0, {0.0, 0.107, 0.111});
  TriangleMesh mesh =
      shapes::append(shapes::cube(1.0, {-0.8, 0, 0}), shapes::cube(1.0, {0.8, 0, 0}));
  const FractureResult result = broken(shapes::append(mesh, rod), exactOptions(2, 48));
  ASSERT_EQ(result.exactFailure, "");
  ASSERT_EQ(result.fragments.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Fragment& fragment = result.fragments[i];
    ASSERT_EQ(fragment.contacts.size(), 1u);
    EXPECT_TRUE(fragment.contacts[0].isThin);
    EXPECT_EQ(fragment.contacts[0].fragment, 2 - static_cast<int>(i));
    EXPECT_GE(fragment.contacts[0].area, (1 - 1e-9) * area);
    EXPECT_LT(fragment.contacts[0].area, 3 * area);
    EXPECT_LT(std::abs(fragment.contacts[0].centroid.x), 0.3);
  }
  const FractureResult wide = broken(shapes::cube(2.0), exactOptions(2, 48));
  ASSERT_EQ(wide.fragments[0].contacts.size(), 1u);
  EXPECT_FALSE(wide.fragments[0].contacts[0].isThin);
}

TEST(Exact, ABodyWithinAnotherVanishes) {
  const TriangleMesh mesh = shapes::append(shapes::cube(2.0), shapes::cube(1.0));
  expectUnited(mesh, exactOptions(5, 40), 2, 8.0, 24.0);
}

// Two cubes that have an edge in common, on a plate: the union has four faces at the edge.
TEST(Exact, SheetsOfAUnionThatTouchAlongAnEdgeAreParted) {
  const TriangleMesh cubes =
      shapes::append(brick({0, 0, 0}, {1, 1, 1}), brick({1, 1, 0}, {1, 1, 1}));
  const TriangleMesh mesh = shapes::append(cubes, brick({0, 0, -0.5}, {2, 2, 0.6}));
  for (const int pieces : {1, 2, 5, 12}) {
    const FractureResult result = broken(mesh, exactOptions(pieces, 40, pieces > 5 ? 1.0 : 0.0));
    ASSERT_EQ(result.exactFailure, "");
    double sum = 0.0;
    std::map<std::array<std::array<double, 3>, 3>, int> cracks;  // faces by their positions
    for (const Fragment& fragment : result.fragments) {
      const TriangleMesh& own = fragment.mesh;
      LabeledMesh labeled{.mesh = own, .other = own.neighbor, .positionId = {}, .chart = {}};
      EXPECT_EQ(touchingEdges(labeled), 0u);
      EXPECT_EQ(nonManifoldEdges(own), 0u);
      EXPECT_EQ(meshComponents(own).count, 1u);
      std::vector<glm::uvec3> merged = own.triangles;  // rough cracks may touch themselves
      const std::vector<std::uint32_t> first = firstAtPosition(own.vertices);
      for (glm::uvec3& t : merged) t = {first[t.x], first[t.y], first[t.z]};
      EXPECT_TRUE(selfCrossings(own.vertices, merged).empty());
      sum += volume(own);
      for (std::size_t t = 0; t < own.triangles.size(); ++t) {
        if (own.neighborOf(t) == 0) continue;
        std::array<std::array<double, 3>, 3> key{};
        for (std::size_t k = 0; k < 3; ++k) {
          const glm::dvec3& v = own.vertices[own.triangles[t][static_cast<int>(k)]];
          key[k] = {v.x, v.y, v.z};
        }
        std::sort(key.begin(), key.end());
        ++cracks[key];
      }
    }
    for (const auto& [face, sides] : cracks) EXPECT_EQ(sides, 2);
    // The edge of length 0.9 moves by 6e-5, and faces of at most 1 beside it turn with it.
    EXPECT_NEAR(sum, 4.2, 4 * 0.9 * 6e-5);
    EXPECT_NE(sum, 4.2);
  }
}

TEST(Exact, UnitedBodiesKeepTheirMaterials) {
  TriangleMesh mesh = shapes::append(shapes::cube(1.0), brick({0.5, -0.2, -0.2}, {0.4, 0.4, 0.4}));
  mesh.attributes.material.assign(24, 1);
  std::fill_n(mesh.attributes.material.begin(), 12, 0u);
  const FractureResult result = broken(mesh, exactOptions(4, 48));
  ASSERT_EQ(result.exactFailure, "");
  const AttributeSource source(mesh);
  double ofSmall = 0.0;
  for (const Fragment& fragment : result.fragments) {
    const SurfaceAttributes own = source.transferTo(fragment.mesh, 99);
    TriangleMesh small{fragment.mesh.vertices, {}};
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      if (own.material[t] == 1) small.triangles.push_back(fragment.mesh.triangles[t]);
    }
    ofSmall += area(small);
  }
  // But for the face on the large cube.  The small one is within it by rounding, so that corners
  // may move by 2^-41; its edges have a length of 4.8.
  EXPECT_NEAR(ofSmall, 5 * 0.16, 4.8 * 2 * 0x1p-41);
}

TEST(Exact, BodiesHaveTheirCavities) {
  const TriangleMesh mesh =
      shapes::append(shapes::hollowBall(1.0, 0.5, 2), shapes::ball(0.2, 2, {0.0, 0.0, 0.0}));
  const std::vector<TriangleMesh> bodies = bodiesOf(mesh);
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(bodies[0].triangles.size(), shapes::hollowBall(1.0, 0.5, 2).triangles.size());
  EXPECT_EQ(bodies[1].triangles.size(), shapes::ball(0.2, 2).triangles.size());
}

TEST(Exact, FragmentsAreOneBody) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    FractureOptions options = exactOptions(12, 48, 1.5);
    options.seed = seed;
    const FractureResult result = broken(shapes::cup(1.0, 0.06, 1.5, 0.1, 40), options);
    ASSERT_EQ(result.exactFailure, "");
    for (const Fragment& fragment : result.fragments) {
      EXPECT_EQ(meshComponents(fragment.mesh).count, 1u);
    }
  }
}

using Corners = std::array<std::array<double, 3>, 2>;

// Returns the length of the edges at which the outer surface bends by more than 30 degrees.
double creaseLength(const TriangleMesh& mesh) {
  std::map<Corners, std::vector<glm::dvec3>> normals;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.neighborOf(t) != 0) continue;
    const glm::uvec3& c = mesh.triangles[t];
    const std::vector<glm::dvec3>& v = mesh.vertices;
    const glm::dvec3 n = glm::normalize(glm::cross(v[c.y] - v[c.x], v[c.z] - v[c.x]));
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 &a = v[c[k]], &b = v[c[(k + 1) % 3]];
      Corners ends{{{a.x, a.y, a.z}, {b.x, b.y, b.z}}};
      std::sort(ends.begin(), ends.end());
      normals[ends].push_back(n);
    }
  }
  double sum = 0.0;
  for (const auto& [ends, around] : normals) {
    if (around.size() != 2 || glm::dot(around[0], around[1]) > std::cos(M_PI / 6)) continue;
    sum += glm::distance(glm::dvec3(ends[0][0], ends[0][1], ends[0][2]),
                         glm::dvec3(ends[1][0], ends[1][1], ends[1][2]));
  }
  return sum;
}

TEST(Exact, SharpEdgesAreFoundAgainInThePieces) {
  for (const TriangleMesh& mesh : {shapes::cube(2.0), shapes::cup(1.0, 0.2, 1.5, 0.2, 10)}) {
    const FractureResult result = broken(mesh, exactOptions(9, 64, 1.0));
    ASSERT_EQ(result.exactFailure, "");
    double sum = 0.0;
    for (const Fragment& fragment : result.fragments) sum += creaseLength(fragment.mesh);
    EXPECT_NEAR(sum / creaseLength(mesh), 1.0, 1e-9);
  }
}

TEST(Exact, AttributesAreTheInputsAndLinearBetween) {
  TriangleMesh mesh = shapes::cube(2.0);
  const auto texcoordAt = [](const glm::dvec3& p) { return glm::vec2(0.3 * p.x + p.y, p.z - p.x); };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<glm::vec2, 3> texcoords;
    for (int k = 0; k < 3; ++k) {
      texcoords[static_cast<std::size_t>(k)] = texcoordAt(mesh.vertices[mesh.triangles[t][k]]);
    }
    mesh.attributes.texcoords.push_back(texcoords);
    mesh.attributes.material.push_back(t / 2);
  }
  const FractureResult result = broken(mesh, exactOptions(5, 48));
  ASSERT_EQ(result.exactFailure, "");
  const AttributeSource source(mesh);
  for (const Fragment& fragment : result.fragments) {
    const SurfaceAttributes own = source.transferTo(fragment.mesh, 99);
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      if (fragment.mesh.source[t] == TriangleMesh::kNoSource) {
        EXPECT_EQ(own.material[t], 99u);
        continue;
      }
      EXPECT_EQ(own.material[t], fragment.mesh.source[t] / 2);
      for (int k = 0; k < 3; ++k) {
        const glm::vec2 expected =
            texcoordAt(fragment.mesh.vertices[fragment.mesh.triangles[t][k]]);
        const glm::vec2 found = own.texcoords[t][static_cast<std::size_t>(k)];
        EXPECT_LT(glm::distance(expected, found), 1e-6);  // single precision of values below 3
      }
    }
  }
}

TEST(Exact, TheSameBytesOnOneThread) {
  const TriangleMesh mesh = shapes::torus(2.0, 0.7, 40, 20);
  FractureResult two = broken(mesh, exactOptions(12, 64, 1.0)), one;
  tbb::task_arena arena(1);
  arena.execute([&] { one = broken(mesh, exactOptions(12, 64, 1.0)); });
  ASSERT_EQ(one.fragments.size(), two.fragments.size());
  for (std::size_t i = 0; i < one.fragments.size(); ++i) {
    EXPECT_EQ(one.fragments[i].mesh.vertices, two.fragments[i].mesh.vertices);
    EXPECT_EQ(one.fragments[i].mesh.triangles, two.fragments[i].mesh.triangles);
  }
}

// Inserts points on every edge of one triangle of each pair, so that triangles without area fill
// the gaps to the other.
TriangleMesh withFlatTriangles(const TriangleMesh& mesh, int points) {
  TriangleMesh out{mesh.vertices, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> isTwin;
  for (const glm::uvec3& t : mesh.triangles) {
    // The triangle as a polygon, with the points of its edges that come first.
    std::vector<std::uint32_t> polygon;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      polygon.push_back(from);
      isTwin[{from, to}] = true;
      if (isTwin.count({to, from}) != 0) continue;
      std::uint32_t last = from;
      for (int i = 1; i <= points; ++i) {
        const double along = static_cast<double>(i) / (points + 1);
        const auto v = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[from] +
                               along * (mesh.vertices[to] - mesh.vertices[from]));
        polygon.push_back(v);
        out.triangles.push_back({last, to, v});  // p -> q, as the twin has q -> p
        last = v;
      }
    }
    const auto center = static_cast<std::uint32_t>(out.vertices.size());
    out.vertices.push_back((mesh.vertices[t.x] + mesh.vertices[t.y] + mesh.vertices[t.z]) / 3.0);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      out.triangles.push_back({polygon[i], polygon[(i + 1) % polygon.size()], center});
    }
  }
  return out;
}

TEST(Exact, TrianglesWithoutAreaAreCutToo) {
  for (const int points : {1, 3, 7}) {  // in exact fractions of the edges
    const TriangleMesh mesh = withFlatTriangles(shapes::cube(2.0), points);
    ASSERT_EQ(openEdges(mesh), 0u);
    for (const double roughness : {0.0, 2.0}) expectExact(mesh, exactOptions(12, 40, roughness));
  }
}

TEST(Exact, APaneThinnerThanAVoxelIsCut) {
  for (const double tilt : {0.0, 0.3}) {  // without voxels inside, and with some
    TriangleMesh pane = shapes::cube(2.0);
    for (glm::dvec3& v : pane.vertices) {
      v.z *= 0.4 / 64;
      v = {v.x * std::cos(tilt) - v.z * std::sin(tilt), v.y,
           v.x * std::sin(tilt) + v.z * std::cos(tilt)};
    }
    for (const double roughness : {0.0, 1.0}) {
      SCOPED_TRACE(std::to_string(tilt) + ", roughness " + std::to_string(roughness));
      expectExact(pane, exactOptions(8, 64, roughness));
    }
    SolidOptions options{.resolution = 64};
    options.keepMesh = true;
    EXPECT_EQ(voxelize(pane, options).report.isThinnerThanVoxels, tilt == 0.0);
  }
}

TEST(Exact, ManyBodiesThatOverlapAreUnited) {
  TriangleMesh mesh;
  for (int k = 0; k < 40; ++k) {
    mesh = shapes::append(std::move(mesh), shapes::cube(1.0, {0.37 * k, 0.11 * (k % 3), 0.07 * k}));
  }
  const UnitedMesh united = unite(mesh);
  ASSERT_EQ(united.failure, "");
  expectUnited(mesh, exactOptions(10, 96), 40, volume(united.mesh), area(united.mesh));
}

// Slabs of a cube, two of which are islands that touch each other as much as their other neighbors:
// each would go to the other's fragment for ever.
TEST(Exact, IslandsThatTouchEachOtherGoToTheirNeighbors) {
  constexpr std::array<std::uint16_t, 7> kLabels{3, 1, 2, 4, 1, 5, 2};
  constexpr std::array<double, 8> kEnds{0.0, 0.2, 0.25, 0.3, 0.5, 0.7, 0.8, 1.0};
  const TriangleMesh cube = shapes::cube(1.0, glm::dvec3(0.5));
  const auto labelAt = [&](const glm::dvec3& p) {
    std::size_t slab = 0;
    while (slab + 1 < kLabels.size() && p.x > kEnds[slab + 1]) ++slab;
    return kLabels[slab];
  };
  LabeledComplex cracks;
  for (std::size_t i = 0; i + 1 < kLabels.size(); ++i) {
    const auto first = static_cast<std::uint32_t>(cracks.vertices.size());
    const double x = kEnds[i + 1];
    for (const auto& [y, z] : {std::pair(-0.2, -0.3), {1.3, -0.2}, {1.2, 1.3}, {-0.3, 1.2}})
      cracks.vertices.emplace_back(x, y, z);
    for (const glm::uvec3& t : {glm::uvec3(0, 1, 2), {0, 2, 3}}) {
      ComplexFace face;
      face.corner = t + first;
      face.front = kLabels[i];
      face.back = face.neighbor = kLabels[i + 1];
      cracks.faces.push_back(face);
    }
  }
  const SpaceLabels space{labelAt, labelAt, [](const glm::dvec3& p) {
                            return p == glm::clamp(p, glm::dvec3(0.0), glm::dvec3(1.0));
                          }};
  const ExactSurface surface = exactSurface(cube, cracks, 5, space);
  ASSERT_EQ(surface.failure, "");
  double sum = 0.0;
  for (const LabeledMesh& mesh : surface.meshes) {
    EXPECT_EQ(meshComponents(mesh.mesh).count, 1u);
    EXPECT_EQ(openEdges(mesh.mesh), 0u);
    sum += volume(mesh.mesh);
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(volume(surface.meshes[0].mesh), 0.2, 1e-12);
  EXPECT_NEAR(volume(surface.meshes[1].mesh), 0.2, 1e-12);
}

// One voxel of a fold is a fragment, and no part of the shell lies within its cracks.
TEST(Exact, AFragmentThatWouldBeEmptyIsSmooth) {
  const TriangleMesh fold{{{0, 0, 0},
                           {3, 0, 0},
                           {3, 0.15410862509615883, 0.37525364149331519},
                           {0, 0.15410862509615883, 0.37525364149331519},
                           {0, 1, 0},
                           {3, 1, 0}},
                          {{0, 1, 2}, {0, 2, 3}, {3, 2, 5}, {3, 5, 4}}};
  FractureOptions options = exactOptions(26, 48, 2.196427);
  options.seed = 11519802206593318077u;
  const FractureResult result = broken(fold, options);
  EXPECT_NE(result.exactFailure.find("would be empty"), std::string::npos) << result.exactFailure;
  for (const Fragment& fragment : result.fragments) EXPECT_FALSE(fragment.mesh.triangles.empty());
}

TEST(Exact, RealMeshesKeepTheirSurface) {
  const char* folder = std::getenv("SHERD_TEST_DATA");
  if (folder == nullptr) {
    GTEST_SKIP() << "SHERD_TEST_DATA is not set: it names the folder of shared meshes";
  }
  for (const char* name :
       {"1002_tray_bottom.STL", "nut-big.obj", "vented_rear_case.ply", "99865_car.stl"}) {
    SCOPED_TRACE(name);
    TriangleMesh mesh = readMesh(std::filesystem::path(folder) / name).mesh;
    mesh.triangles = repaired(mesh).mesh.triangles;
    expectExact(mesh, exactOptions(10, 72, 1.0));
  }
}

}  // namespace
}  // namespace sherd
