// Fragments whose meshes are made in the paper's way.
#include <gtest/gtest.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>

#include "kernels/device_fixture.h"
#include "mesh_checks.h"
#include "shapes.h"

namespace sherd {
namespace {

using openvdb::Coord;

const Coord kSteps[6] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

using LabelSurface = DeviceTest;

FractureOptions bareLabels(Growth growth = Growth::flood) {
  FractureOptions options{.pieces = 6, .seed = 4, .solid = {.resolution = 40}};
  options.seeds.extraSeedsPerPiece = 2;
  options.grow.growth = growth;
  options.grow.roughness = 1.0;
  options.surface.surface = Surface::labels;
  return options;
}

TEST_F(LabelSurface, FragmentsAreTheirVoxels) {
  const FractureResult result = fracture(shapes::cup(1.0, 0.3, 1.5, 0.3), bareLabels(), device());
  const Solid& solid = result.solid;
  const double h = solid.frame.voxelSize;
  std::map<Coord, std::uint16_t> label;
  solid.blocks->forEachInside([&](std::size_t voxelIndex) {
    label[solid.blocks->voxelAt(voxelIndex)] = result.labels.fragment[voxelIndex];
  });
  for (const Fragment& fragment : result.fragments) {
    SCOPED_TRACE(fragment.id);
    expectClosedManifold(fragment.mesh);
    EXPECT_EQ(coincidentVertices(fragment.mesh), 0u);
    EXPECT_NEAR(fragment.mass.volume, static_cast<double>(fragment.voxels) * h * h * h,
                fragment.area * 1.125 / 64 * h);

    // The voxels' faces, counted, against the area that faces each.  A face whose corners moved by
    // at most 1/64 changes its area by less than a tenth.
    std::map<std::uint16_t, double> counted;
    for (const auto& [voxel, id] : label) {
      if (id != fragment.id) continue;
      for (const Coord& step : kSteps) {
        const auto beyond = label.find(voxel + step);
        const std::uint16_t other = beyond == label.end() ? std::uint16_t{0} : beyond->second;
        if (other != id) counted[other] += h * h;
      }
    }
    const std::map<std::uint16_t, double> measured = areas(fragment.mesh);
    ASSERT_EQ(measured.size(), counted.size());
    for (const auto& [other, size] : counted) EXPECT_NEAR(measured.at(other), size, 0.1 * size);

    // Each triangle faces the voxel beyond it.
    for (std::size_t t = 0; t < fragment.mesh.neighbor.size(); ++t) {
      const glm::uvec3& c = fragment.mesh.triangles[t];
      const glm::dvec3 a = fragment.mesh.vertices[c.x], b = fragment.mesh.vertices[c.y],
                       d = fragment.mesh.vertices[c.z];
      const glm::dvec3 at = solid.frame.indexFromWorld(
          (a + b + d) / 3.0 + 0.25 * h * glm::normalize(glm::cross(b - a, d - a)));
      const glm::ivec3 voxel(glm::round(at));
      const auto beyond = label.find(Coord(voxel.x, voxel.y, voxel.z));
      ASSERT_EQ(fragment.mesh.neighbor[t], beyond == label.end() ? 0 : beyond->second);
    }
  }
}

TEST_F(LabelSurface, TwoSidesOfACrackHaveOneSurface) {
  const FractureResult result = fracture(shapes::ball(1.0), bareLabels(Growth::euclid), device());
  for (const Fragment& fragment : result.fragments) {
    for (const Contact& contact : fragment.contacts) {
      const Fragment& other = result.fragments[static_cast<std::size_t>(contact.fragment) - 1];
      const double here = areas(fragment.mesh).at(static_cast<std::uint16_t>(contact.fragment));
      const double there = areas(other.mesh).at(static_cast<std::uint16_t>(fragment.id));
      EXPECT_NEAR(here, there, 0.1 * here);  // as above; equal where no sheets touch
    }
  }
}

TEST_F(LabelSurface, ErodedFacesKeepWhatTheyFaced) {
  FractureOptions options = bareLabels(Growth::euclid);
  options.grow.roughness = 0.0;
  options.seeds.extraSeedsPerPiece = 0;
  const FractureResult whole = fracture(shapes::ball(1.0), options, device());
  options.erode.iterations = 2;
  const FractureResult eroded = fracture(shapes::ball(1.0), options, device());
  ASSERT_GT(eroded.eroded[0], 0u);
  for (std::size_t i = 0; i < eroded.fragments.size(); ++i) {
    const Fragment& fragment = eroded.fragments[i];
    expectClosedManifold(fragment.mesh);
    // Two layers off a crack: its faces lie deeper in, and face no fragment that was not there.
    EXPECT_GT(fragment.fractureArea, 0.0);
    for (const auto& [other, size] : areas(fragment.mesh)) {
      EXPECT_NE(other, fragment.id);
      EXPECT_NE(other, Labels::kEroded);
      EXPECT_LE(other, eroded.fragments.size());
    }
    EXPECT_LT(fragment.voxels, whole.fragments[i].voxels);
  }
}

using DecimatedFracture = DeviceTest;

TEST_F(DecimatedFracture, EveryFragmentStaysClosedAndKeepsWhatItFaces) {
  for (const Surface surface : {Surface::smooth, Surface::labels}) {
    FractureOptions options{.pieces = 7, .seed = 2, .solid = {.resolution = 64}};
    options.surface.surface = surface;
    options.surface.triangles = {1500, 300};
    if (surface == Surface::labels) {
      options.surface.smooth.iterations = options.surface.smooth.boundaryIterations = {3};
    }
    const FractureResult result = fracture(shapes::cup(1.0, 0.3, 1.5, 0.3), options, device());
    for (const Fragment& fragment : result.fragments) {
      ASSERT_EQ(fragment.coarse.size(), 2u);
      for (std::size_t i = 0; i < 2; ++i) {
        const TriangleMesh& coarse = fragment.coarse[i];
        SCOPED_TRACE(i);
        EXPECT_LE(coarse.triangles.size(), options.surface.triangles[i]);
        expectClosedManifold(coarse);
        EXPECT_EQ(regions(coarse), regions(fragment.mesh));
        // Half a voxel over the surface is what the mesh itself may be off by.
        EXPECT_NEAR(volume(coarse), fragment.mass.volume,
                    0.5 * result.solid.frame.voxelSize * fragment.area);
      }
    }
  }
}

TEST_F(DecimatedFracture, HasNoFaceThatSinglePrecisionTakesForALine) {
  TriangleMesh plate = shapes::cube(1.0, glm::dvec3(0.5));
  for (glm::dvec3& v : plate.vertices) v.z *= 0.15;
  FractureOptions options{.pieces = 6, .seed = 4, .solid = {.resolution = 96}};
  options.surface.triangles = {1000};
  for (const Fragment& fragment : fracture(plate, options, device()).fragments) {
    std::size_t lines = 0;
    for (const glm::uvec3& corner : fragment.coarse[0].triangles) {
      glm::dvec3 p[3];  // as a file has them
      for (int k = 0; k < 3; ++k) p[k] = glm::vec3(fragment.coarse[0].vertices[corner[k]]);
      const double longest =
          std::max({glm::length(p[1] - p[0]), glm::length(p[2] - p[1]), glm::length(p[0] - p[2])});
      lines += glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) < 1e-6 * longest;
    }
    EXPECT_EQ(lines, 0u) << fragment.id;
  }
}

}  // namespace
}  // namespace sherd
