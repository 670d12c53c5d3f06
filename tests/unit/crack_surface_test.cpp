// The surfaces between fragments, and what simplification keeps of them.
#include "surface/crack_surface.h"

#include <gtest/gtest.h>
#include <sherd/fracture.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "exact/self_crossings.h"
#include "mesh/triangle_tree.h"
#include "shapes.h"
#include "surface/merge_facets.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {
namespace {

constexpr double kTolerance = 0.1;  // voxels

Complex simplified(const Complex& cracks, double tolerance, std::uint64_t seed) {
  return withMergedFacets(
             cracks, {.facets = {.cracks = {.tolerance = tolerance}}, .displacementSeed = seed})
      .complex;
}

// A fracture by planes, with its cracks in world units.
struct Cracked {
  FractureResult result;
  Complex cracks;

  Cracked(const TriangleMesh& mesh, int pieces, double roughness = 0.0) {
    Device device("builtin");
    FractureOptions options{.pieces = pieces, .seed = 3, .solid = {.resolution = 48}};
    options.grow.roughness = roughness;
    result = fracture(mesh, options, device);
    const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(result.solid.blocks->origins);
    const Cut cut = findCut(result.labels, neighborhoods, CutExtent::exact);
    const Labels beyond = labelsBeyond(result.solid, result.labels, cut, neighborhoods);
    cracks = crackSurface(result.solid, beyond, cut, neighborhoods);
  }

  double voxel() const { return result.solid.frame.voxelSize; }
  Complex simple() const { return simplified(cracks, kTolerance * voxel(), 0); }
};

std::size_t crossings(const Complex& cracks) {
  return selfCrossings(cracks.vertices, trianglesOf(cracks)).size();
}

TriangleMesh meshOf(const Complex& cracks) { return {cracks.vertices, trianglesOf(cracks)}; }

// Edges that the surface of a label uses more often in one direction.
std::set<std::array<std::uint32_t, 2>> openEdges(const Complex& cracks) {
  std::map<std::array<std::uint32_t, 3>, int> balance;  // lower end, higher end, label
  for (const ComplexFace& face : cracks.faces) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = face.corner[k], b = face.corner[(k + 1) % 3];
      const int forward = a < b ? 1 : -1;
      balance[{std::min(a, b), std::max(a, b), face.front}] += forward;
      balance[{std::min(a, b), std::max(a, b), face.back}] -= forward;
    }
  }
  std::set<std::array<std::uint32_t, 2>> open;
  for (const auto& [edge, sum] : balance) {
    if (sum != 0) open.insert({edge[0], edge[1]});
  }
  return open;
}

// The least distance of open edges from the unit ball, negative inside, of their nearer ends and of
// their farther ends.
struct Overhang {
  double nearer = 1e9, farther = 1e9;
};

Overhang overhangOf(const Complex& cracks) {
  Overhang least;
  for (const auto& [a, b] : openEdges(cracks)) {
    const auto [low, high] =
        std::minmax({glm::length(cracks.vertices[a]) - 1.0, glm::length(cracks.vertices[b]) - 1.0});
    least.nearer = std::min(least.nearer, low);
    least.farther = std::min(least.farther, high);
  }
  return least;
}

// The seeds of labels, in index space.
std::map<std::uint16_t, glm::dvec3> seedsOf(const Cracked& cracked) {
  std::map<std::uint16_t, glm::dvec3> seeds;
  for (const Seed& seed : cracked.result.labels.sites.seeds) seeds[seed.fragment] = pointOf(seed);
  return seeds;
}

// How far a point lies beyond the plane half way from `own` to `other`.
double beyond(const glm::dvec3& p, const glm::dvec3& own, const glm::dvec3& other) {
  return glm::dot(p - 0.5 * (own + other), glm::normalize(other - own));
}

TEST(CrackSurface, LiesOnTheBisectorPlanesOfSeeds) {
  for (const int pieces : {2, 8}) {
    for (const bool isBall : {true, false}) {
      const Cracked cracked(isBall ? shapes::ball(1.0) : shapes::cube(1.0), pieces);
      const double cellDiagonal = std::sqrt(3.0) * cracked.voxel();
      const auto hasInsideCell = [&](const glm::dvec3& p) {
        const glm::dvec3 size = glm::abs(p) + cellDiagonal;
        return isBall ? glm::length(p) + cellDiagonal < 1.0
                      : std::max({size.x, size.y, size.z}) < 0.5;
      };
      const std::map<std::uint16_t, glm::dvec3> seeds = seedsOf(cracked);
      ASSERT_EQ(seeds.size(), static_cast<std::size_t>(pieces));
      std::size_t onPlanes = 0;
      for (const ComplexFace& face : cracked.cracks.faces) {
        const glm::dvec3 &front = seeds.at(face.front), &back = seeds.at(face.back);
        for (int k = 0; k < 3; ++k) {
          const glm::dvec3 p =
              cracked.result.solid.frame.indexFromWorld(cracked.cracks.vertices[face.corner[k]]);
          // The plane passes between two neighboring voxels with the labels, the vertex lies in a
          // cell with both or, where lines between cells are straightened, in one beside it.
          const double distance = std::abs(beyond(p, front, back));
          EXPECT_LE(distance, 2.0 * std::sqrt(3.0));
          // Beyond the solid voxels have no seeds, and the cut is continued by smoothing.
          if (!hasInsideCell(cracked.cracks.vertices[face.corner[k]])) continue;
          const bool isNearOthers = std::any_of(seeds.begin(), seeds.end(), [&](const auto& other) {
            return other.first != face.front && other.first != face.back &&
                   std::max(beyond(p, front, other.second), beyond(p, back, other.second)) > -3.0;
          });
          if (isNearOthers) continue;
          // Vertices keep 0.005 voxels from the faces of their cells, along each axis.
          EXPECT_LE(distance, 0.005 * std::sqrt(3.0) + 1e-6);
          ++onPlanes;
        }
      }
      EXPECT_GT(2 * onPlanes, cracked.cracks.faces.size());  // of three corners each
    }
  }
}

TEST(CrackSurface, IsClosedAroundEveryLabelInsideTheSolid) {
  for (const int pieces : {2, 8, 30}) {
    for (const double roughness : {0.0, 1.5}) {
      const Cracked cracked(shapes::ball(1.0, 5), pieces, roughness);
      EXPECT_FALSE(openEdges(cracked.cracks).empty());
      // A quad is missing where a cell has a corner at least three voxels beyond the solid.  Its
      // four cells share an edge, so an open edge's ends lie in one that has a face in common with
      // that cell, within sqrt(6) voxels, and in one that may have an edge in common only,
      // within 3.
      const Overhang overhang = overhangOf(cracked.cracks);
      EXPECT_GT(overhang.nearer, 0.0);
      EXPECT_GE(overhang.farther, (3.0 - std::sqrt(6.0)) * cracked.voxel());
      EXPECT_GT(overhangOf(cracked.simple()).nearer, 0.0);
    }
  }
}

TEST(CrackSurface, DoesNotCrossItself) {
  for (const int pieces : {2, 8, 30}) {
    for (const double roughness : {0.0, 1.5}) {
      const Cracked cracked(shapes::ball(1.0), pieces, roughness);
      EXPECT_EQ(crossings(cracked.cracks), 0u);
      EXPECT_EQ(crossings(cracked.simple()), 0u);
    }
  }
}

TEST(CrackSurface, IsTheSameWithOneThreadAndTwo) {
  std::vector<Complex> all;
  for (const std::size_t threads : {1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Cracked cracked(shapes::torus(1.0, 0.4), 12, 1.0);
    all.push_back(cracked.cracks);
    all.push_back(cracked.simple());
  }
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(all[i].vertices, all[2 + i].vertices);
    EXPECT_TRUE(std::equal(all[i].faces.begin(), all[i].faces.end(), all[2 + i].faces.begin(),
                           all[2 + i].faces.end(), [](const ComplexFace& a, const ComplexFace& b) {
                             return a.corner == b.corner && a.front == b.front && a.back == b.back;
                           }));
  }
}

TEST(SimplifiedCracks, OfAPlaneHaveFewTriangles) {
  const Cracked cracked(shapes::ball(1.0), 2);
  const Complex simple = cracked.simple();
  const std::map<std::uint16_t, glm::dvec3> seeds = seedsOf(cracked);
  for (const glm::dvec3& v : simple.vertices) {
    const glm::dvec3 p = cracked.result.solid.frame.indexFromWorld(v);
    // Displaced by at most a thousandth of the tolerance along each axis.
    EXPECT_LE(std::abs(beyond(p, seeds.at(1), seeds.at(2))), 1e-3 * kTolerance * 2.0 + 1e-5);
  }
  // A polygon without inner vertices, whose border had about a vertex per voxel or more.
  const double perimeter = 2.0 * std::numbers::pi * (1.0 / cracked.voxel() + 3.0);  // voxels
  EXPECT_LT(static_cast<double>(simple.faces.size()), perimeter);
  EXPECT_GT(cracked.cracks.faces.size(), 20 * simple.faces.size());
  // The open border moves by five tolerances at most.
  EXPECT_NEAR(area(meshOf(simple)), area(meshOf(cracked.cracks)),
              2.0 * perimeter * 5.0 * kTolerance * std::pow(cracked.voxel(), 2));
}

TEST(SimplifiedCracks, StayNearTheCracks) {
  for (const double roughness : {0.0, 1.5}) {
    const Cracked cracked(shapes::cube(1.0), 8, roughness);
    const TriangleTree before(meshOf(cracked.cracks));
    const Complex simple = cracked.simple();
    EXPECT_LT(simple.faces.size(), cracked.cracks.faces.size());
    // Vertices move by ten tolerances at most onto their planes, single faces join facets up to
    // four away.
    const double reach = 14.1 * kTolerance * cracked.voxel();
    for (const ComplexFace& face : simple.faces) {
      const glm::dvec3 middle = (simple.vertices[face.corner.x] + simple.vertices[face.corner.y] +
                                 simple.vertices[face.corner.z]) /
                                3.0;
      EXPECT_LE(before.nearest(middle, 2.0 * reach).distance, reach);
    }
  }
}

TEST(SimplifiedCracks, AreDisplacedBySeed) {
  const Cracked cracked(shapes::cube(1.0), 8);
  const double tolerance = kTolerance * cracked.voxel();
  const Complex a = simplified(cracked.cracks, tolerance, 0);
  EXPECT_EQ(simplified(cracked.cracks, tolerance, 0).vertices, a.vertices);
  EXPECT_NE(simplified(cracked.cracks, tolerance, 1).vertices, a.vertices);
  EXPECT_TRUE(simplified({}, tolerance, 0).faces.empty());
}

// A ramp that winds around the z axis, over [10, 10 + width], two turns within less than a
// tolerance of 1: each turn covers the one below in the projection along the axis.
Complex ramp(std::uint32_t width) {
  constexpr std::uint32_t kSteps = 160;
  Complex cracks;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const double angle = 4.0 * std::numbers::pi * i / kSteps;
    for (std::uint32_t j = 0; j <= width; ++j) {
      cracks.vertices.emplace_back((10.0 + j) * std::cos(angle), (10.0 + j) * std::sin(angle),
                                   0.02 * angle);
    }
  }
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    for (std::uint32_t j = 0; j < width; ++j) {
      const std::uint32_t v = i * (width + 1) + j, next = v + width + 1;
      cracks.faces.push_back({{v, v + 1, next + 1}, 1, 2});
      cracks.faces.push_back({{v, next + 1, next}, 1, 2});
    }
  }
  return cracks;
}

TEST(SimplifiedCracks, KeepTheFacesOfAFacetThatCoversItself) {
  // Splitting faces off its border does not help.
  for (const std::uint32_t width : {2u, 30u}) {
    const Complex cracks = ramp(width);
    const Complex simple = simplified(cracks, 1.0, 0);
    EXPECT_EQ(crossings(simple), 0u);
    EXPECT_NEAR(area(meshOf(simple)), area(meshOf(cracks)), 0.05 * area(meshOf(cracks)));
  }
}

TEST(SimplifiedCracks, MayHaveFacesWithoutArea) {
  // A row of them has no plane.
  Complex cracks;
  for (int i = 0; i < 9; ++i) cracks.vertices.emplace_back(i, 0.0, 0.0);
  for (std::uint32_t i = 0; i + 2 < 9; ++i) {
    cracks.faces.push_back(
        {i % 2 == 0 ? glm::uvec3(i, i + 1, i + 2) : glm::uvec3(i + 1, i, i + 2), 1, 2});
  }
  const Complex simple = simplified(cracks, 1e-3, 0);
  EXPECT_LE(simple.faces.size(), cracks.faces.size());
  for (const glm::dvec3& v : simple.vertices) EXPECT_TRUE(std::isfinite(v.x + v.y + v.z));
}

}  // namespace
}  // namespace sherd
