// Nearly planar regions of crack surfaces.
#include "remesh/decimate/facets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <vector>

#include "base/random.h"

namespace sherd {
namespace {

// A sheet of n * n squares over [0, n]^2, each of two triangles, its front above it.
LabeledComplex sheet(std::uint32_t n, const std::function<glm::dvec3(double, double)>& at) {
  LabeledComplex cracks;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) cracks.vertices.push_back(at(i, j));
  }
  const auto vertex = [n](std::uint32_t i, std::uint32_t j) { return i * (n + 1) + j; };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const glm::uvec4 v(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
      cracks.faces.push_back({{v.x, v.y, v.z}, 1, 2});
      cracks.faces.push_back({{v.x, v.z, v.w}, 1, 2});
    }
  }
  return cracks;
}

double noise(std::uint64_t item) { return 2.0 * randomUnit(3, Stage::noise, item) - 1.0; }

FaceEdges edgesOf(const LabeledComplex& cracks) {
  return {trianglesOf(cracks), cracks.vertices.size()};
}

Facets facetsOf(const LabeledComplex& cracks, double tolerance) {
  return facetsOf(cracks, edgesOf(cracks), FacetOptions{.cracks = {.tolerance = tolerance}});
}

// Two half planes that meet in the line x = n / 2, z = 0 at an angle of `degrees` between normals.
LabeledComplex folded(std::uint32_t n, double degrees) {
  const double angle = degrees / 180.0 * std::acos(-1.0), middle = n / 2.0;
  return sheet(n, [=](double x, double y) {
    const double apart = x - middle;
    if (apart <= 0.0) return glm::dvec3(x, y, 0.0);
    return glm::dvec3(middle + std::cos(angle) * apart, y, std::sin(angle) * apart);
  });
}

TEST(Facets, APlaneIsOneFacet) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(-0.3, 0.2, 1.0));
  const LabeledComplex cracks =
      sheet(12, [](double x, double y) { return glm::dvec3(x, y, 0.3 * x - 0.2 * y + 7.0); });
  const Facets facets = facetsOf(cracks, 1e-9);
  ASSERT_EQ(facets.planes.size(), 1u);
  EXPECT_LT(glm::distance(facets.planes[0].normal, normal), 1e-12);
  EXPECT_EQ(facets.ofFace, std::vector<std::uint32_t>(cracks.faces.size(), 0));
}

TEST(Facets, HalfPlanesAtALargeAngleAreTwo) {
  // Beyond 60 degrees no face joins the other plane's facet, at any tolerance.
  for (const double degrees : {61.0, 90.0, 120.0}) {
    const LabeledComplex cracks = folded(12, degrees);
    const Facets facets = facetsOf(cracks, 100.0);
    ASSERT_EQ(facets.planes.size(), 2u);
    EXPECT_NEAR(glm::dot(facets.planes[0].normal, facets.planes[1].normal),
                std::cos(degrees / 180.0 * std::acos(-1.0)), 1e-12);
    for (std::size_t f = 0; f < cracks.faces.size(); ++f) {
      EXPECT_EQ(facets.ofFace[f], f < cracks.faces.size() / 2 ? 0u : 1u);
    }
  }
}

TEST(Facets, HaveTheirCornersWithinTheToleranceOfTheirPlane) {
  // Waves of three times the tolerance.  The plane moves as long as faces are added: it was within
  // the tolerance of each when that was added, with at least half of the final faces but the last
  // few, so that twice the tolerance and what small facets may add is an upper bound.
  const double tolerance = 0.2;
  const LabeledComplex cracks = sheet(40, [=](double x, double y) {
    return glm::dvec3(x, y, 3.0 * tolerance * std::sin(0.3 * x) * std::cos(0.25 * y));
  });
  const Facets facets = facetsOf(cracks, tolerance);
  EXPECT_GT(facets.planes.size(), 4u);
  EXPECT_LT(facets.planes.size(), cracks.faces.size() / 16);
  for (std::size_t f = 0; f < cracks.faces.size(); ++f) {
    if (facets.ofFace[f] == Facets::kNone) continue;
    const Facets::Plane& plane = facets.planes[facets.ofFace[f]];
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 apart = cracks.vertices[cracks.faces[f].corner[k]] - plane.point;
      EXPECT_LE(std::abs(glm::dot(apart, plane.normal)), 4.0 * tolerance);
    }
  }
}

TEST(Facets, OtherLabelsAndEdgesOfThreeFacesSeparateFacets) {
  LabeledComplex cracks = sheet(8, [](double x, double y) { return glm::dvec3(x, y, 0.0); });
  for (std::size_t f = 64; f < 128; ++f) cracks.faces[f].back = 3;
  EXPECT_EQ(facetsOf(cracks, 0.1).planes.size(), 2u);
  for (std::size_t f = 64; f < 128; ++f) cracks.faces[f].back = 2;
  EXPECT_EQ(facetsOf(cracks, 0.1).planes.size(), 1u);
  // A wall on the line x = 4, between labels 1 and 3: below it is 2.
  const auto first = static_cast<std::uint32_t>(cracks.vertices.size());
  for (std::uint32_t j = 0; j <= 8; ++j) cracks.vertices.emplace_back(4.0, j, 1.0);
  for (std::uint32_t j = 0; j < 8; ++j) {
    const std::uint32_t low = 4 * 9 + j, high = first + j;
    cracks.faces.push_back({{low, low + 1, high + 1}, 1, 3});
    cracks.faces.push_back({{low, high + 1, high}, 1, 3});
  }
  const Facets facets = facetsOf(cracks, 0.1);
  EXPECT_EQ(facets.planes.size(), 2u);  // and the wall's 16 faces are too few for a facet
  EXPECT_EQ(std::count(facets.ofFace.begin(), facets.ofFace.end(), Facets::kNone), 16);
  EXPECT_EQ(std::count(facets.ofFace.end() - 16, facets.ofFace.end(), Facets::kNone), 16);
}

TEST(Facets, SnappingMovesABorderToTheLineOfItsPlanes) {
  // The vertices of the fold are displaced along x, by less than a square.
  constexpr std::uint32_t kSide = 24;
  LabeledComplex cracks = folded(kSide, 90.0);
  const glm::dvec3* const fold = &cracks.vertices[kSide / 2 * (kSide + 1)];
  for (std::uint32_t j = 0; j <= kSide; ++j) {
    cracks.vertices[kSide / 2 * (kSide + 1) + j] += glm::dvec3(0.1 * noise(j), 0.0, 0.0);
  }
  const Facets facets = facetsOf(cracks, 0.15);
  ASSERT_EQ(facets.planes.size(), 2u);
  const std::vector<glm::dvec3> moved = snapped(cracks, facets, 1.0);
  for (std::size_t v = 0; v < moved.size(); ++v) {
    const bool isOnFold = &cracks.vertices[v] >= fold && &cracks.vertices[v] <= fold + kSide;
    if (!isOnFold) continue;
    for (const Facets::Plane& plane : facets.planes) {
      // A pull of 1/1000 towards where it was leaves that share of the distances, over the least
      // eigenvalue of the planes' normals.
      const double least =
          1.0 - std::abs(glm::dot(facets.planes[0].normal, facets.planes[1].normal));
      EXPECT_LE(std::abs(glm::dot(moved[v] - plane.point, plane.normal)), 1e-3 * 0.15 / least);
    }
  }
}

TEST(Facets, SnappingLeavesVerticesThatWouldMoveFar) {
  const LabeledComplex cracks = folded(24, 90.0);
  Facets facets = facetsOf(cracks, 0.1);
  ASSERT_EQ(facets.planes.size(), 2u);
  for (Facets::Plane& plane : facets.planes) plane.point.z += 3.0;
  EXPECT_EQ(snapped(cracks, facets, 2.0), cracks.vertices);
  EXPECT_NE(snapped(cracks, facets, 4.0), cracks.vertices);
}

TEST(Facets, SnappingLeavesVerticesOfOtherFaces) {
  const LabeledComplex cracks = folded(24, 90.0);
  Facets facets = facetsOf(cracks, 0.1);
  for (Facets::Plane& plane : facets.planes) plane.point.z += 0.5;
  facets.ofFace[100] = Facets::kNone;
  const std::vector<glm::dvec3> moved = snapped(cracks, facets, 1.0);
  const glm::uvec3& fixed = cracks.faces[100].corner;
  for (const std::uint32_t v : {fixed.x, fixed.y, fixed.z}) EXPECT_EQ(moved[v], cracks.vertices[v]);
  EXPECT_NE(moved, cracks.vertices);
}

}  // namespace
}  // namespace sherd
