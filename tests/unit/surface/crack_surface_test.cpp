// The surfaces between fragments, and what simplification keeps of them.
#include "surface/exact/crack_surface.h"

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
#include <utility>
#include <vector>

#include "intersect/self_crossings.h"
#include "mesh/search/triangle_tree.h"
#include "remesh/decimate/merge_facets.h"
#include "remesh/decimate/simplified_cracks.h"
#include "shapes.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

constexpr double kTolerance = 0.1;  // voxels

// Of cracks in voxels that overhang nothing.
LabeledComplex simplified(const LabeledComplex& cracks, double tolerance, std::uint64_t seed) {
  return simplifiedCracks(cracks, {}, {}, {.adaptivity = tolerance, .displacementSeed = seed});
}

// A fracture by planes, with its cracks in world units.
struct Cracked {
  TriangleMesh mesh;
  FractureResult result;
  LabeledComplex cracks;

  Cracked(TriangleMesh of, int pieces, double roughness = 0.0, CrackEnds ends = CrackEnds::quads)
      : mesh(std::move(of)) {
    Device device("builtin");
    FractureOptions options{.pieces = pieces, .seed = 3, .solid = {.resolution = 48}};
    options.grow.roughness = roughness;
    result = fracture(mesh, options, device);
    const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(result.solid.blocks->origins);
    const Cut cut = findCut(result.labels, neighborhoods, CutExtent::exact);
    const Labels beyond = labelsBeyond(result.solid, result.labels, cut, neighborhoods);
    cracks = crackSurface(result.solid, beyond, cut, neighborhoods, nullptr, ends);
  }

  double voxel() const { return result.solid.frame.voxelSize; }
  LabeledComplex simple(double adaptivity = kTolerance, std::uint64_t seed = 0) const {
    return simplifiedCracks(cracks, mesh, result.solid.frame,
                            {.adaptivity = adaptivity, .displacementSeed = seed});
  }
};

std::size_t crossings(const LabeledComplex& cracks) {
  return selfCrossings(cracks.vertices, trianglesOf(cracks)).size();
}

TriangleMesh meshOf(const LabeledComplex& cracks) { return {cracks.vertices, trianglesOf(cracks)}; }

// Edges that the surface of a label uses more often in one direction.
std::set<std::array<std::uint32_t, 2>> openCrackEdges(const LabeledComplex& cracks) {
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

Overhang overhangOf(const LabeledComplex& cracks) {
  Overhang least;
  for (const auto& [a, b] : openCrackEdges(cracks)) {
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
      EXPECT_FALSE(openCrackEdges(cracked.cracks).empty());
      // A quad is missing where a cell has a corner at least three voxels beyond the solid.  Its
      // four cells share an edge, so an open edge's ends lie in one that has a face in common with
      // that cell, within sqrt(6) voxels, and in one that may have an edge in common only,
      // within 3.
      const Overhang overhang = overhangOf(cracked.cracks);
      EXPECT_GT(overhang.nearer, 0.0);
      EXPECT_GE(overhang.farther, (3.0 - std::sqrt(6.0)) * cracked.voxel());
      EXPECT_GT(overhangOf(cracked.simple(kAutoAdaptivity)).nearer, 0.0);
      if (pieces == 8) {
        EXPECT_GT(overhangOf(cracked.simple()).nearer, 0.0);
      }
    }
  }
}

TEST(CrackSurface, WithHalfQuadsHasMoreFacesBeyondTheSolid) {
  const Cracked quads(shapes::ball(1.0), 60);
  const Cracked more(shapes::ball(1.0), 60, 0.0, CrackEnds::halfQuads);
  const auto cornersOf = [](const LabeledComplex& cracks) {
    std::set<std::array<std::array<double, 3>, 3>> all;
    for (const glm::uvec3& t : trianglesOf(cracks)) {
      std::array<std::array<double, 3>, 3> own;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3& v = cracks.vertices[t[k]];
        own[static_cast<std::size_t>(k)] = {v.x, v.y, v.z};
      }
      std::sort(own.begin(), own.end());
      all.insert(own);
    }
    return all;
  };
  const auto before = cornersOf(quads.cracks), after = cornersOf(more.cracks);
  EXPECT_GT(after.size(), before.size() + 100);
  EXPECT_TRUE(std::includes(after.begin(), after.end(), before.begin(), before.end()));
  for (const auto& face : after) {
    if (before.contains(face)) continue;
    for (const auto& [x, y, z] : face) EXPECT_GT(std::hypot(x, y, z), 1.0);
  }
  EXPECT_GE(overhangOf(more.cracks).nearer, overhangOf(quads.cracks).nearer);
  EXPECT_EQ(crossings(more.cracks), 0u);
}

TEST(CrackSurface, DoesNotCrossItself) {
  for (const int pieces : {2, 8, 30}) {
    for (const double roughness : {0.0, 1.5}) {
      const Cracked cracked(shapes::ball(1.0), pieces, roughness);
      EXPECT_EQ(crossings(cracked.cracks), 0u);
      EXPECT_EQ(crossings(cracked.simple(kAutoAdaptivity)), 0u);
      if (pieces == 8) {
        EXPECT_EQ(crossings(cracked.simple()), 0u);
      }
    }
  }
}

TEST(CrackSurface, IsTheSameWithOneThreadAndTwo) {
  std::vector<LabeledComplex> all;
  for (const std::size_t threads : {1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Cracked cracked(shapes::torus(1.0, 0.4), 12, 1.0);
    all.push_back(cracked.cracks);
    all.push_back(cracked.simple());
    all.push_back(cracked.simple(kAutoAdaptivity));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(all[i].vertices, all[3 + i].vertices);
    EXPECT_TRUE(std::equal(all[i].faces.begin(), all[i].faces.end(), all[3 + i].faces.begin(),
                           all[3 + i].faces.end(), [](const ComplexFace& a, const ComplexFace& b) {
                             return a.corner == b.corner && a.front == b.front && a.back == b.back;
                           }));
  }
}

TEST(SimplifiedCracks, OfAPlaneHaveFewTriangles) {
  const Cracked cracked(shapes::ball(1.0), 2);
  const LabeledComplex simple = cracked.simple();
  const std::map<std::uint16_t, glm::dvec3> seeds = seedsOf(cracked);
  for (const glm::dvec3& v : simple.vertices) {
    const glm::dvec3 p = cracked.result.solid.frame.indexFromWorld(v);
    EXPECT_LE(std::abs(beyond(p, seeds.at(1), seeds.at(2))), kTolerance);
  }
  // A polygon without inner vertices that is nowhere nearer to the ball than by
  // CrackOverhang::kLeastOverhang and reaches three voxels beyond it: between these two circles an
  // edge spans an angle of up to 2 acos((r + 0.1) / (r + 3)), and edges are taken greedily.
  const double radius = 1.0 / cracked.voxel();
  const double most = 2.0 * std::acos((radius + 0.1) / (radius + 3.0));
  EXPECT_LT(static_cast<double>(simple.faces.size()), 3.0 * 2.0 * std::numbers::pi / most);
  EXPECT_GT(overhangOf(simple).nearer, 0.0);
}

// Returns points of a face, at least `perVoxel` for each voxel of its longest edge.
std::vector<glm::dvec3> pointsOf(const std::array<glm::dvec3, 3>& t, double voxel,
                                 double perVoxel) {
  const double longest =
      std::max({glm::distance(t[0], t[1]), glm::distance(t[1], t[2]), glm::distance(t[2], t[0])});
  const int n = static_cast<int>(std::ceil(perVoxel * longest / voxel));
  std::vector<glm::dvec3> points;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j)
      points.push_back(t[0] + (t[1] - t[0]) * (1.0 * i / n) + (t[2] - t[0]) * (1.0 * j / n));
  }
  return points;
}

std::vector<glm::dvec3> cornersAndMiddle(const std::array<glm::dvec3, 3>& t) {
  return {t[0], t[1], t[2], (t[0] + t[1] + t[2]) / 3.0};
}

struct Deviation {
  double rms = 0.0, most = 0.0;  // voxels
};

// The distances from `to` of some points of the faces of `from`, those that are inside the mesh.
// The mean is by area.
template <class Points>
Deviation deviation(const Cracked& cracked, const LabeledComplex& from, const LabeledComplex& to,
                    const Points& pointsOfFace) {
  const TriangleTree solid(cracked.mesh), tree(meshOf(to));
  Deviation found;
  double sum = 0.0, areas = 0.0;
  for (const ComplexFace& face : from.faces) {
    const std::array t{from.vertices[face.corner.x], from.vertices[face.corner.y],
                       from.vertices[face.corner.z]};
    const std::vector<glm::dvec3> points = pointsOfFace(t);
    const double share =
        glm::length(glm::cross(t[1] - t[0], t[2] - t[0])) / static_cast<double>(points.size());
    for (const glm::dvec3& p : points) {
      if (solid.winding(p) < 0.5) continue;
      const double distance = tree.nearest(p, 100.0).distance / cracked.voxel();
      found.most = std::max(found.most, distance);
      sum += share * distance * distance;
      areas += share;
    }
  }
  if (areas > 0.0) found.rms = std::sqrt(sum / areas);
  return found;
}

// Both ways: planes, planes that walls bend, and rough cracks.  Planes are merged first, within
// kPlanarCrackTolerance.
TEST(SimplifiedCracks, StayWithinTheToleranceOfTheCracksInTheMean) {
  for (const auto& [mesh, roughness] : {std::pair(shapes::cube(1.0), 0.0),
                                        {shapes::cube(1.0), 1.5},
                                        {shapes::cup(1.0, 0.1, 1.5, 0.15, 40), 0.0}}) {
    const Cracked cracked(mesh, 3, roughness);
    for (const double tolerance : {0.1, 0.5}) {
      SCOPED_TRACE(std::to_string(roughness) + ", tolerance " + std::to_string(tolerance));
      const LabeledComplex simple = cracked.simple(tolerance);
      EXPECT_LT(simple.faces.size(), cracked.cracks.faces.size() / 2);
      EXPECT_EQ(crossings(simple), 0u);
      const auto every = [&](const std::array<glm::dvec3, 3>& t) {
        return pointsOf(t, cracked.voxel(), 2.0);
      };
      const Deviation full = deviation(cracked, cracked.cracks, simple, cornersAndMiddle);
      const Deviation own = deviation(cracked, simple, cracked.cracks, every);
      EXPECT_LE(full.rms, tolerance + kPlanarCrackTolerance);
      EXPECT_LE(own.rms, tolerance + kPlanarCrackTolerance);
    }
  }
}

TEST(SimplifiedCracks, AreNeverMoreThanMergedPlanes) {
  for (const auto& [mesh, roughness] : {std::pair(shapes::cube(1.0), 0.0),
                                        {shapes::cube(1.0), 1.5},
                                        {shapes::torus(1.0, 0.2), 0.0},
                                        {shapes::cup(1.0, 0.1, 1.5, 0.15, 40), 0.0}}) {
    const Cracked cracked(mesh, 4, roughness);
    const std::size_t merged = cracked.simple(kAutoAdaptivity).faces.size();
    for (const double tolerance : {0.01, 0.05, 0.2, 1.0})
      EXPECT_LE(cracked.simple(tolerance).faces.size(), merged) << tolerance;
  }
}

TEST(MergedCracks, OfAPlaneHaveFewTriangles) {
  const Cracked cracked(shapes::ball(1.0), 2);
  const LabeledComplex simple = cracked.simple(kAutoAdaptivity);
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

// A full crack has two faces for each voxel that it passes, a wall of the cup with what overhangs
// it on both sides ten voxels or more.
TEST(MergedCracks, OfAThinWallHaveFewTriangles) {
  for (const double wall : {0.05, 0.1}) {
    const Cracked cracked(shapes::cup(1.0, wall, 1.5, 0.15, 69), 2);
    const LabeledComplex simple = cracked.simple(kAutoAdaptivity);
    EXPECT_LT(simple.faces.size(), cracked.cracks.faces.size() / 10);
    EXPECT_EQ(crossings(simple), 0u);
    EXPECT_LE(deviation(cracked, cracked.cracks, simple, cornersAndMiddle).rms,
              2.0 * kPlanarCrackTolerance);
  }
}

TEST(MergedCracks, StayNearTheCracks) {
  for (const double roughness : {0.0, 1.5}) {
    const Cracked cracked(shapes::cube(1.0), 8, roughness);
    const LabeledComplex simple = cracked.simple(kAutoAdaptivity);
    EXPECT_LT(simple.faces.size(), cracked.cracks.faces.size());
    // Vertices move by ten tolerances at most onto their planes, single faces join facets up to
    // four away.
    EXPECT_LE(deviation(cracked, simple, cracked.cracks, cornersAndMiddle).most, 14.1 * kTolerance);
  }
}

TEST(SimplifiedCracks, AreDisplacedBySeed) {
  const Cracked cracked(shapes::ball(1.0), 3);
  const LabeledComplex a = cracked.simple(kTolerance, 0);
  EXPECT_EQ(cracked.simple(kTolerance, 0).vertices, a.vertices);
  EXPECT_NE(cracked.simple(kTolerance, 1).vertices, a.vertices);
  EXPECT_TRUE(simplified({}, kTolerance, 0).faces.empty());
}

TEST(SimplifiedCracks, KeepAllFacesWithoutATolerance) {
  const Cracked cracked(shapes::cube(1.0), 3, 1.0);
  const LabeledComplex simple = cracked.simple(0.0);
  EXPECT_EQ(simple.faces.size(), cracked.cracks.faces.size());
  EXPECT_LE(deviation(cracked, simple, cracked.cracks, cornersAndMiddle).most,
            std::sqrt(3.0) * 1e-3 * kPlanarCrackTolerance + 1e-6);  // and the rounding of positions
}

// A ramp that winds around the z axis, over [10, 10 + width], two turns within less than a
// tolerance of 1: each turn covers the one below in the projection along the axis.
LabeledComplex ramp(std::uint32_t width) {
  constexpr std::uint32_t kSteps = 160;
  LabeledComplex cracks;
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

TEST(MergedCracks, KeepTheFacesOfAFacetThatCoversItself) {
  // Splitting faces off its border does not help.
  for (const std::uint32_t width : {2u, 30u}) {
    const LabeledComplex cracks = ramp(width);
    const LabeledComplex simple =
        withMergedFacets(cracks, {.facets = {.cracks = {.tolerance = 1.0}}, .displacementSeed = 0})
            .complex;
    EXPECT_EQ(crossings(simple), 0u);
    EXPECT_NEAR(area(meshOf(simple)), area(meshOf(cracks)), 0.05 * area(meshOf(cracks)));
  }
}

// A plane with an edge at which the same two labels have two more faces, above and below.
TEST(MergedCracks, WithAFaultOfTheirOwnHaveFewTrianglesElsewhere) {
  constexpr std::uint32_t kSide = 30, kMiddle = 15;
  LabeledComplex cracks;
  for (std::uint32_t i = 0; i <= kSide; ++i) {
    for (std::uint32_t j = 0; j <= kSide; ++j) cracks.vertices.emplace_back(i, j, 0.0);
  }
  const auto at = [](std::uint32_t i, std::uint32_t j) { return i * (kSide + 1) + j; };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    cracks.faces.push_back({{a, b, c}, 1, 2});
    cracks.faces.push_back({{a, c, d}, 1, 2});
  };
  for (std::uint32_t i = 0; i < kSide; ++i) {
    for (std::uint32_t j = 0; j < kSide; ++j)
      add(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
  for (const double z : {1.0, -1.0}) {
    const auto first = static_cast<std::uint32_t>(cracks.vertices.size());
    cracks.vertices.emplace_back(kMiddle + 1, kMiddle, z);
    cracks.vertices.emplace_back(kMiddle, kMiddle, z);
    add(at(kMiddle, kMiddle), at(kMiddle + 1, kMiddle), first, first + 1);
  }
  const LabeledComplex simple = simplifiedCracks(cracks, {}, {}, {.adaptivity = kAutoAdaptivity});
  EXPECT_LT(simple.faces.size(), cracks.faces.size() / 4);
}

TEST(SimplifiedCracks, OfARampThatCoversItselfDoNotCross) {
  for (const std::uint32_t width : {2u, 30u}) {
    const LabeledComplex cracks = ramp(width);
    const LabeledComplex simple = simplified(cracks, 1.0, 0);
    EXPECT_LT(simple.faces.size(), cracks.faces.size());
    EXPECT_EQ(crossings(simple), 0u);
  }
}

TEST(SimplifiedCracks, MayHaveFacesWithoutArea) {
  // A row of them has no plane.
  LabeledComplex cracks;
  for (int i = 0; i < 9; ++i) cracks.vertices.emplace_back(i, 0.0, 0.0);
  for (std::uint32_t i = 0; i + 2 < 9; ++i) {
    cracks.faces.push_back(
        {i % 2 == 0 ? glm::uvec3(i, i + 1, i + 2) : glm::uvec3(i + 1, i, i + 2), 1, 2});
  }
  const LabeledComplex simple = simplified(cracks, 1e-3, 0);
  EXPECT_LE(simple.faces.size(), cracks.faces.size());
  for (const glm::dvec3& v : simple.vertices) EXPECT_TRUE(std::isfinite(v.x + v.y + v.z));
}

}  // namespace
}  // namespace sherd
