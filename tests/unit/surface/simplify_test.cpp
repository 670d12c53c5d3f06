// Merging of the triangles in planes, where the input is piecewise flat.
#include "surface/simplify.h"

#include <gtest/gtest.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "intersect/self_crossings.h"
#include "mesh/repair/flat_share.h"
#include "mesh_checks.h"
#include "shapes.h"

namespace sherd {
namespace {

FractureOptions optionsFor(double adaptivity, int resolution = 64) {
  FractureOptions options{.pieces = 8, .seed = 3, .solid = {.resolution = resolution}};
  options.surface.levelSets = false;
  options.surface.adaptivity = adaptivity;
  return options;
}

std::vector<Fragment> fragmentsOf(const TriangleMesh& mesh, const FractureOptions& options) {
  Device device("builtin");
  return fracture(mesh, options, device).fragments;
}

std::size_t sortedTriangles(const std::vector<Fragment>& fragments) {
  std::size_t count = 0;
  for (const Fragment& fragment : fragments) count += fragment.mesh.triangles.size();
  return count;
}

std::size_t crossingsOf(const std::vector<Fragment>& fragments) {
  std::size_t count = 0;
  for (const Fragment& fragment : fragments)
    count += selfCrossings(fragment.mesh.vertices, fragment.mesh.triangles).size();
  return count;
}

using Position = std::tuple<double, double, double>;

// The triangles between two fragments, counter-clockwise seen from the lower id, by positions.
std::set<std::array<Position, 3>> cracksBeside(const Fragment& fragment, std::uint16_t neighbor) {
  std::set<std::array<Position, 3>> all;
  for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
    if (fragment.mesh.neighbor[t] != neighbor) continue;
    std::array<Position, 3> at;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& v = fragment.mesh.vertices[fragment.mesh.triangles[t][k]];
      at[static_cast<std::size_t>(k)] = {v.x, v.y, v.z};
    }
    if (neighbor < fragment.id) std::swap(at[1], at[2]);
    std::rotate(at.begin(), std::min_element(at.begin(), at.end()), at.end());
    all.insert(at);
  }
  return all;
}

void expectSoundFragments(const std::vector<Fragment>& fragments) {
  for (const Fragment& fragment : fragments) {
    SCOPED_TRACE(fragment.id);
    EXPECT_EQ(openEdges(fragment.mesh), 0u);
    EXPECT_EQ(nonManifoldEdges(fragment.mesh), 0u);
    EXPECT_EQ(nonManifoldVertices(fragment.mesh), 0u);
    for (const Contact& contact : fragment.contacts) {
      const Fragment& other = fragments[static_cast<std::size_t>(contact.fragment) - 1];
      EXPECT_EQ(cracksBeside(fragment, static_cast<std::uint16_t>(other.id)),
                cracksBeside(other, static_cast<std::uint16_t>(fragment.id)));
    }
  }
}

double volumeOf(const std::vector<Fragment>& fragments) {
  double sum = 0.0;
  for (const Fragment& fragment : fragments) sum += fragment.mass.volume;
  return sum;
}

// A cube whose faces are grids of n * n squares.
TriangleMesh gridCube(int n) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {0.0, 1.0}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
          glm::dvec3 p;
          p[axis] = side;
          p[(axis + 1) % 3] = static_cast<double>(i) / n;
          p[(axis + 2) % 3] = static_cast<double>(j) / n;
          mesh.vertices.push_back(p);
        }
      }
      const auto at = [&](int i, int j) {
        return first + static_cast<std::uint32_t>(i * (n + 1) + j);
      };
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          for (glm::uvec3 t : {glm::uvec3(at(i, j), at(i + 1, j), at(i + 1, j + 1)),
                               glm::uvec3(at(i, j), at(i + 1, j + 1), at(i, j + 1))}) {
            if (side == 0.0) std::swap(t.y, t.z);
            mesh.triangles.push_back(t);
          }
        }
      }
    }
  }
  return mesh;
}

TEST(FlatShare, OfACubeIsWhatLiesAwayFromItsEdges) {
  for (const double reach : {0.01, 0.1}) {
    const double expected = std::pow(1.0 - 2.0 * reach, 2);
    // Of 1000 samples; five standard deviations.
    const double error = 5.0 * std::sqrt(expected * (1.0 - expected) / 1000.0);
    EXPECT_NEAR(flatShare(TriangleTree(shapes::cube(1.0)), reach), expected, error);
    EXPECT_NEAR(flatShare(TriangleTree(gridCube(50)), reach), expected, error);
  }
}

TEST(FlatShare, OfABallIsNothingUnlessItsTrianglesAreLarge) {
  EXPECT_EQ(flatShare(TriangleTree(shapes::ball(64.0, 6)), 0.5), 0.0);
  EXPECT_GT(flatShare(TriangleTree(shapes::ball(64.0, 1)), 0.5), 0.8);
}

TEST(FlatShare, OfNothingIsNothing) {
  EXPECT_EQ(flatShare(TriangleTree(TriangleMesh{}), 1.0), 0.0);
  const TriangleMesh line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(flatShare(TriangleTree(line), 1.0), 0.0);
}

TEST(MergedPlanes, MakeFewTrianglesOfACube) {
  for (const std::uint64_t seed : {1u, 7u}) {
    FractureOptions options = optionsFor(kAutoAdaptivity, 128);
    options.seed = seed;
    for (const TriangleMesh& mesh : {shapes::cube(1.0), gridCube(64)}) {
      const std::vector<Fragment> fragments = fragmentsOf(mesh, options);
      EXPECT_LT(sortedTriangles(fragments), 3000u);
      expectSoundFragments(fragments);
      EXPECT_EQ(crossingsOf(fragments), 0u);
      // Cracks may move by their tolerance, but what one fragment loses another has.
      EXPECT_NEAR(volumeOf(fragments), 1.0, 6.0 * kPlanarTolerance / 128.0);
    }
  }
}

// Distances of the original surface's vertices from the faces of a cube, by position.
std::map<Position, double> distancesFromCube(const std::vector<Fragment>& fragments) {
  const Box box = bounds(shapes::cube(1.0));
  std::map<Position, double> all;
  for (const Fragment& fragment : fragments) {
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      if (fragment.mesh.neighbor[t] != 0) continue;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3& v = fragment.mesh.vertices[fragment.mesh.triangles[t][k]];
        double& nearest = all.try_emplace({v.x, v.y, v.z}, 1.0).first->second;
        for (int axis = 0; axis < 3; ++axis) {
          nearest = std::min(
              {nearest, std::abs(v[axis] - box.min[axis]), std::abs(v[axis] - box.max[axis])});
        }
      }
    }
  }
  return all;
}

TEST(MergedPlanes, AreThoseOfManyFragmentsToo) {
  FractureOptions options = optionsFor(kAutoAdaptivity);
  options.pieces = 700;
  const std::vector<Fragment> merged = fragmentsOf(shapes::cube(1.0), options);
  options.surface.adaptivity = 0.0;
  const std::vector<Fragment> all = fragmentsOf(shapes::cube(1.0), options);
  EXPECT_LT(2 * sortedTriangles(merged), sortedTriangles(all));
  EXPECT_LE(crossingsOf(merged), crossingsOf(all));
  expectSoundFragments(merged);
}

TEST(MergedPlanes, StayOnTheInput) {
  const double voxel = 1.0 / 64.0;
  const auto before = distancesFromCube(fragmentsOf(shapes::cube(1.0), optionsFor(0.0)));
  const auto after = distancesFromCube(fragmentsOf(shapes::cube(1.0), optionsFor(kAutoAdaptivity)));
  EXPECT_LT(20 * after.size(), before.size());
  for (const auto& [at, distance] : after) {  // others stay where they are
    EXPECT_TRUE(distance <= kPlanarTolerance * voxel || before.contains(at)) << distance / voxel;
  }
}

TEST(MergedPlanes, AreSoundWithRoughAndErodedCracksAndOfEachFragmentAlone) {
  FractureOptions rough = optionsFor(kAutoAdaptivity), eroded = rough, independent = rough;
  rough.grow.roughness = 2.0;
  eroded.erode.iterations = 2;
  independent.surface.interface = Interface::independent;
  for (FractureOptions options : {rough, eroded, independent}) {
    const std::vector<Fragment> merged = fragmentsOf(shapes::cube(1.0), options);
    if (options.surface.interface == Interface::shared && options.erode.iterations.isZero()) {
      expectSoundFragments(merged);
    }
    options.surface.adaptivity = 0.0;
    const std::vector<Fragment> all = fragmentsOf(shapes::cube(1.0), options);
    EXPECT_LT(sortedTriangles(merged), sortedTriangles(all));
    EXPECT_LE(crossingsOf(merged), crossingsOf(all));
    for (const Fragment& fragment : merged) {
      EXPECT_EQ(openEdges(fragment.mesh) + nonManifoldEdges(fragment.mesh) +
                    nonManifoldVertices(fragment.mesh),
                0u);
    }
    double cracks = 0.0;  // each fragment's own
    for (const Fragment& fragment : all) cracks += fragment.fractureArea;
    EXPECT_NEAR(volumeOf(merged), volumeOf(all), cracks * kPlanarCrackTolerance / 64.0);
  }
}

TEST(MergedPlanes, LeaveCurvedInputsAsTheyAre) {
  for (const TriangleMesh& mesh : {shapes::ball(1.0), shapes::torus(2.0, 0.8, 200, 80)}) {
    const std::vector<Fragment> merged = fragmentsOf(mesh, optionsFor(kAutoAdaptivity)),
                                all = fragmentsOf(mesh, optionsFor(0.0));
    ASSERT_EQ(merged.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(merged[i].mesh.vertices, all[i].mesh.vertices);
      EXPECT_EQ(merged[i].mesh.triangles, all[i].mesh.triangles);
      EXPECT_FALSE(merged[i].mesh.isMerged);
    }
  }
}

TEST(MergedPlanes, AreTheSameWithAnIntactSurface) {
  const Solid solid = voxelize(shapes::cube(1.0), {.resolution = 48});
  Device device("builtin");
  FractureOptions options = optionsFor(kAutoAdaptivity);
  options.solid = {};
  const FractureResult alone = fracture(solid, options, device);
  const auto intact = intactSurface(alone.solid);
  const std::vector<Fragment> again =
      extractFragments(alone.solid, alone.labels, {.surface = options.surface, .intact = intact});
  ASSERT_EQ(again.size(), alone.fragments.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].mesh.vertices, alone.fragments[i].mesh.vertices);
    EXPECT_EQ(again[i].mesh.triangles, alone.fragments[i].mesh.triangles);
  }
}

TEST(MergedPlanes, OfTheIntactSolidAreThoseOfOneFragment) {
  FractureOptions options = optionsFor(kAutoAdaptivity);
  options.pieces = 1;
  Device device("builtin");
  const FractureResult result = fracture(shapes::cube(1.0), options, device);
  const TriangleMesh whole = solidMesh(result.solid);
  EXPECT_EQ(whole.vertices, result.fragments.front().mesh.vertices);
  EXPECT_EQ(whole.triangles, result.fragments.front().mesh.triangles);
  EXPECT_LE(whole.triangles.size(), 100u);
  EXPECT_GT(solidMesh(result.solid, 0.0).triangles.size(), 10000u);
}

}  // namespace
}  // namespace sherd
