// Noise on points of fragments: the same with and without meshes, heights and normals as asked.
#include <gtest/gtest.h>
#include <sherd/fracture.h>
#include <sherd/points.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <memory>
#include <vector>

#include "kernels/device_fixture.h"
#include "mesh/search/triangle_tree.h"
#include "pipeline/fracture_stages.h"
#include "shapes.h"
#include "surface/fragment_surfaces.h"

namespace sherd {
namespace {

class NoisePoints : public DeviceTest {
 protected:
  // The points of each fragment of a mesh.
  std::vector<SurfacePoints> sampled(const TriangleMesh& mesh, const SurfaceOptions& surface,
                                     std::size_t count, bool meshes = false, int pieces = 2) {
    FractureOptions options{.pieces = pieces, .seed = 5, .solid = {.resolution = 48}};
    options.surface = surface;
    options.surface.surface = Surface::smooth;
    options.surface.levelSets = false;
    options.surface.points = true;
    GrownFracture grown = sherd::grown(mesh, options, device(), nullptr);
    if (meshes) {
      result_ = extracted(grown, options, nullptr);
    } else {
      result_ = grown.result;
      measureFragments(grown, result_, options.surface, nullptr);
    }
    const auto& surfaces = result_.surfaces ? result_.surfaces : result_.unmerged;
    return samplePoints(*surfaces, {.count = count, .seed = 9});
  }

  double voxel() const { return result_.solid.frame.voxelSize; }

  FractureResult result_;
};

double rmsOf(const std::vector<double>& heights) {
  double sum = 0.0;
  for (const double height : heights) sum += height * height;
  return std::sqrt(sum / static_cast<double>(heights.size()));
}

TEST_F(NoisePoints, AreTheSameWithAndWithoutMeshes) {
  for (const TriangleMesh& mesh : {shapes::ball(1.0, 4), shapes::cube(1.0)}) {
    for (const Interface interface : {Interface::shared, Interface::independent}) {
      SurfaceOptions surface{.interface = interface};
      for (const double rms : {0.0, 0.2}) {
        surface.mismatch.rms = surface.scanNoise.rms = rms;
        const std::vector<SurfacePoints> bare = sampled(mesh, surface, 300, false, 6),
                                         meshed = sampled(mesh, surface, 300, true, 6);
        ASSERT_EQ(bare.size(), 6u);
        for (std::size_t i = 0; i < bare.size(); ++i) {
          EXPECT_EQ(bare[i].positions, meshed[i].positions);
          EXPECT_EQ(bare[i].normals, meshed[i].normals);
          EXPECT_EQ(bare[i].neighbor, meshed[i].neighbor);
          // Off the mesh that replaces vertices by at most what these may be.
          const TriangleTree tree(result_.fragments[i].mesh);
          for (const glm::dvec3& at : meshed[i].positions)
            EXPECT_LT(tree.nearest(at, 10.0 * voxel()).distance, 0.8 * voxel());
        }
      }
    }
  }
}

TEST_F(NoisePoints, MoveAlongNormalsByWhatIsAskedFor) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const double diagonal = 2.0 * std::sqrt(3.0);
  SurfaceOptions surface;
  const std::vector<SurfacePoints> plain = sampled(ball, surface, 20'000, false, 12);
  surface.mismatch.rms = 0.2;
  const std::vector<SurfacePoints> cracks = sampled(ball, surface, 20'000, false, 12);
  surface.mismatch.rms = 0.0;
  surface.scanNoise.rms = 0.1;
  const std::vector<SurfacePoints> all = sampled(ball, surface, 20'000, false, 12);
  std::vector<double> within, everywhere;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    std::vector<glm::dvec3> outside;
    for (std::size_t k = 0; k < plain[i].positions.size(); ++k)
      if (plain[i].neighbor[k] == 0 && k % 4 == 0) outside.push_back(plain[i].positions[k]);
    ASSERT_EQ(plain[i].neighbor, cracks[i].neighbor);
    for (std::size_t k = 0; k < plain[i].positions.size(); ++k) {
      const glm::dvec3 n = plain[i].normals[k];
      const glm::dvec3 by = cracks[i].positions[k] - plain[i].positions[k];
      const glm::dvec3 noise = all[i].positions[k] - plain[i].positions[k];
      EXPECT_LT(glm::length(glm::cross(by, n)), 1e-12);
      EXPECT_LT(glm::length(glm::cross(noise, n)), 1e-12);
      everywhere.push_back(glm::dot(noise, n));
      EXPECT_NEAR(glm::length(cracks[i].normals[k]), 1.0, 1e-12);
      if (plain[i].neighbor[k] == 0) {
        EXPECT_EQ(by, glm::dvec3(0.0));
        EXPECT_EQ(cracks[i].normals[k], n);
      } else if (k % 8 == 0 && glm::length(plain[i].positions[k]) < 1.0 - 4.0 * voxel()) {
        within.push_back(glm::dot(by, n));
      }
    }
  }
  // Contacts of twelve pieces have boundaries inside too, where little is left: by less than a
  // tenth of their area.  About 600 patches of independent heights: known to 3 %.
  EXPECT_NEAR(rmsOf(within) / (0.002 * diagonal), 0.95, 0.1);
  EXPECT_NEAR(rmsOf(everywhere) / (0.001 * diagonal), 1.0, 0.08);
}

TEST_F(NoisePoints, FallToTheBoundary) {
  const TriangleMesh cube = shapes::cube(1.0);
  SurfaceOptions surface;
  const std::vector<SurfacePoints> plain = sampled(cube, surface, 100'000);
  surface.mismatch.rms = 0.3;
  const std::vector<SurfacePoints> moved = sampled(cube, surface, 100'000);
  const auto toBox = [](const glm::dvec3& at) {
    double least = 1.0;
    for (int k = 0; k < 3; ++k) least = std::min(least, 0.5 - std::abs(at[k]));
    return least;
  };
  std::vector<double> near, far;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    for (std::size_t k = 0; k < plain[i].positions.size(); ++k) {
      if (plain[i].neighbor[k] == 0) continue;
      const double height = glm::distance(plain[i].positions[k], moved[i].positions[k]);
      const double distance = toBox(plain[i].positions[k]);
      if (distance < 0.1 * voxel()) near.push_back(height);
      if (distance > 3.0 * voxel()) far.push_back(height);
    }
  }
  ASSERT_GT(near.size(), 50u);
  // 3 x^2 of the height at a tenth of a voxel, of a fade over one or more.
  EXPECT_LT(rmsOf(near), 0.05 * rmsOf(far));
  EXPECT_NEAR(rmsOf(far) / (0.003 * std::sqrt(3.0)), 1.0, 0.3);  // some 20 patches
}

// The two sides of a plane, by a common height: moved by the same vector.
TEST_F(NoisePoints, SidesOfACommonMismatchStayTogether) {
  const TriangleMesh cube = shapes::cube(1.0);
  SurfaceOptions surface;
  surface.mismatch.rms = 0.3;
  for (const double common : {0.0, 1.0}) {
    surface.mismatchCommon = common;
    const std::vector<SurfacePoints> moved = sampled(cube, surface, 200'000);
    // From each point of one side to the plane of the nearest of the other.
    std::vector<double> gaps, heights;
    for (std::size_t k = 0; k < moved[0].positions.size(); k += 200) {
      if (moved[0].neighbor[k] == 0) continue;
      double least = 1.0;
      double gap = 0.0;
      for (std::size_t j = 0; j < moved[1].positions.size(); ++j) {
        if (moved[1].neighbor[j] == 0) continue;
        const glm::dvec3 by = moved[1].positions[j] - moved[0].positions[k];
        if (glm::length(by) >= least) continue;
        least = glm::length(by);
        gap = glm::dot(by, moved[1].normals[j]);
      }
      gaps.push_back(gap);
    }
    ASSERT_GT(gaps.size(), 100u);
    const double asked = 0.003 * std::sqrt(3.0);
    if (common == 1.0) {
      EXPECT_LT(rmsOf(gaps), 0.15 * asked);
    } else {
      EXPECT_GT(rmsOf(gaps), 0.5 * asked);
    }
  }
}

// Of the plane through the points around each, by least squares.  They are within a quarter of a
// voxel, so waves of a voxel leave an error, which is far below the angle that the noise makes.
TEST_F(NoisePoints, NormalsAreThoseOfTheMovedSurface) {
  const TriangleMesh cube = shapes::cube(1.0);
  SurfaceOptions surface;
  const std::vector<SurfacePoints> plain = sampled(cube, surface, 1'000'000);
  surface.mismatch = {.rms = 0.3, .hurst = 0.6, .wavelength = 10.0};
  const std::vector<SurfacePoints> moved = sampled(cube, surface, 1'000'000);
  std::vector<double> off, without;
  std::vector<std::size_t> cracks;
  for (std::size_t k = 0; k < moved[0].positions.size(); ++k)
    if (moved[0].neighbor[k] != 0) cracks.push_back(k);
  for (std::size_t c = 0; c < cracks.size(); c += cracks.size() / 300) {
    const std::size_t k = cracks[c];
    const glm::dvec3 n0 = plain[0].normals[k];
    const glm::dvec3 u = glm::normalize(
        glm::cross(n0, std::abs(n0.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const glm::dvec3 v = glm::cross(n0, u);
    glm::dmat3 sums(0.0);
    glm::dvec3 right(0.0);
    int count = 0;
    for (const std::size_t j : cracks) {
      const glm::dvec3 by = moved[0].positions[j] - moved[0].positions[k];
      if (glm::length(by) > 0.25 * voxel()) continue;
      const glm::dvec3 row{glm::dot(by, u), glm::dot(by, v), 1.0};
      sums += glm::outerProduct(row, row);
      right += row * glm::dot(by, n0);
      ++count;
    }
    if (count < 10) continue;
    const glm::dvec3 slope = glm::inverse(sums) * right;
    const glm::dvec3 fitted = glm::normalize(n0 - slope.x * u - slope.y * v);
    off.push_back(glm::distance(fitted, moved[0].normals[k]));
    without.push_back(glm::distance(fitted, n0));
  }
  ASSERT_GT(off.size(), 200u);
  EXPECT_LT(rmsOf(off), 0.35 * rmsOf(without));
  EXPECT_GT(rmsOf(without), 0.1);
}

}  // namespace
}  // namespace sherd
