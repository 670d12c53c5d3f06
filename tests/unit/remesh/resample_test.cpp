// Fragments meshed by random points of their surface: no trace of voxels, the same surface.
#include "remesh/resample/resample.h"

#include <gtest/gtest.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <set>
#include <vector>

#include "base/random.h"
#include "intersect/self_crossings.h"
#include "kernels/device_fixture.h"
#include "mesh/search/nearest_on_triangle.h"
#include "mesh_checks.h"
#include "shapes.h"

namespace sherd {
namespace {

using Resample = DeviceTest;

FractureOptions resampleOptions(Interface interface, std::uint64_t seed) {
  FractureOptions options{.pieces = 6, .seed = seed, .solid = {.resolution = 40}};
  options.surface.interface = interface;
  options.surface.surface = Surface::smooth;
  options.surface.adaptivity = 0.0;
  return options;
}

// A rotation by Euler's angles, so that a shape's own planes are not those of the grid.
TriangleMesh rotatedShape(TriangleMesh mesh, double a, double b) {
  for (glm::dvec3& v : mesh.vertices) {
    v = {std::cos(a) * v.x - std::sin(a) * v.y, std::sin(a) * v.x + std::cos(a) * v.y, v.z};
    v = {v.x, std::cos(b) * v.y - std::sin(b) * v.z, std::sin(b) * v.y + std::cos(b) * v.z};
  }
  return mesh;
}

// The mean over the axes of |sum exp(2 pi i x / h)|^2 / n: 1 in the mean for points without a grid.
double gridPower(const std::vector<glm::dvec3>& points, double h) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    std::complex<double> total = 0.0;
    for (const glm::dvec3& p : points)
      total += std::polar(1.0, 2.0 * std::numbers::pi * p[axis] / h);
    sum += std::norm(total) / static_cast<double>(points.size());
  }
  return sum / 3.0;
}

// That of the vertices of a ball's fragments, outside their cracks: planes across an axis have
// power of their own.
double meanPower(Interface interface, Device& device) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const FractureResult result =
        fracture(shapes::ball(1.0), resampleOptions(interface, seed), device);
    for (const Fragment& f : result.fragments) {
      std::vector<bool> isOnCrack(f.mesh.vertices.size(), false);
      for (std::size_t t = 0; t < f.mesh.triangles.size(); ++t) {
        for (int k = 0; f.mesh.neighbor[t] != 0 && k < 3; ++k)
          isOnCrack[f.mesh.triangles[t][k]] = true;
      }
      std::vector<glm::dvec3> outside;
      for (std::size_t v = 0; v < isOnCrack.size(); ++v) {
        if (!isOnCrack[v]) outside.push_back(f.mesh.vertices[v]);
      }
      sum += gridPower(outside, result.solid.frame.voxelSize);
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

TEST_F(Resample, TheGridIsNotInTheVertices) {
  EXPECT_GT(meanPower(Interface::shared, device()), 5.0);
  // Of 48 fragments, 144 numbers of an exponential distribution: the standard error is 0.08.
  EXPECT_LT(meanPower(Interface::independent, device()), 1.25);
}

double distanceTo(const TriangleMesh& mesh, const glm::dvec3& p) {
  double least = INFINITY;
  for (const glm::uvec3& t : mesh.triangles) {
    least = std::min(least,
                     glm::distance(p, nearestOnTriangle(p, mesh.vertices[t.x], mesh.vertices[t.y],
                                                        mesh.vertices[t.z])));
  }
  return least;
}

TEST_F(Resample, TheSurfaceStays) {
  // Chords of a ball of radius 20 voxels are 1 / 160 voxel off, of twice their length a fortieth; a
  // vertex that collapses may be kMostResampled off.
  const TriangleMesh ball = shapes::ball(1.0);
  const FractureResult shared = fracture(ball, resampleOptions(Interface::shared, 3), device());
  const FractureResult own = fracture(ball, resampleOptions(Interface::independent, 3), device());
  const double h = own.solid.frame.voxelSize;
  for (std::size_t i = 0; i < 2; ++i) {
    double sum = 0.0, most = 0.0;
    for (const glm::dvec3& v : shared.fragments[i].mesh.vertices) {
      const double distance = distanceTo(own.fragments[i].mesh, v) / h;
      sum += distance;
      most = std::max(most, distance);
    }
    EXPECT_LT(sum / static_cast<double>(shared.fragments[i].mesh.vertices.size()), 0.02);
    EXPECT_LT(most, kMostResampled + 0.025);
    EXPECT_NEAR(own.fragments[i].mass.volume / shared.fragments[i].mass.volume, 1.0, 0.002);
  }
}

TEST_F(Resample, CreasesStay) {
  // Of a rotated cube in one piece.  Its corners are where the mesh before had them, if there.
  const TriangleMesh cube = rotatedShape(shapes::cube(1.0), 0.4, 0.7);
  FractureOptions options = resampleOptions(Interface::independent, 1);
  options.pieces = 1;
  const FractureResult own = fracture(cube, options, device());
  options.surface.interface = Interface::shared;
  const FractureResult shared = fracture(cube, options, device());
  const double h = own.solid.frame.voxelSize;
  const auto toVertices = [](const TriangleMesh& mesh, const glm::dvec3& p) {
    double least = INFINITY;
    for (const glm::dvec3& v : mesh.vertices) least = std::min(least, glm::distance(p, v));
    return least;
  };
  for (const glm::dvec3& corner : cube.vertices) {
    const double before = toVertices(shared.fragments[0].mesh, corner);
    EXPECT_LT(before, 0.5 * h);
    EXPECT_LT(toVertices(own.fragments[0].mesh, corner), before + 0.01 * h);
  }
  for (const glm::uvec3& t : cube.triangles) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 &a = cube.vertices[t[k]], &b = cube.vertices[t[(k + 1) % 3]];
      for (double share = 0.1; share < 1.0; share += 0.1) {
        EXPECT_LT(distanceTo(own.fragments[0].mesh, a + share * (b - a)),
                  (kMostOffFeature + 0.05) * h);
      }
    }
  }
}

TEST_F(Resample, MeshesAreClosedAndOfOneBody) {
  for (const TriangleMesh& shape : {shapes::cup(1.0, 0.1, 1.5, 0.1, 64), shapes::torus(1.0, 0.2)}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      FractureOptions options = resampleOptions(Interface::independent, seed);
      options.grow.roughness = 1.5;
      options.pieces = 20;
      for (const Fragment& f : fracture(shape, options, device()).fragments) {
        expectClosedManifold(f.mesh);
        EXPECT_EQ(meshComponents(f.mesh).count, 1u);
        EXPECT_GT(volume(f.mesh), 0.0);
      }
    }
  }
}

TEST_F(Resample, AFractureOfOneVoxelPiecesKeepsThem) {
  // Fragments of a few voxels, all of whose vertices may be corners.
  FractureOptions options = resampleOptions(Interface::independent, 1);
  options.solid.resolution = 8;
  options.pieces = 40;
  options.shares.minShare = 0.0;
  for (const Fragment& f : fracture(shapes::ball(1.0), options, device()).fragments) {
    expectClosedManifold(f.mesh);
    EXPECT_GT(volume(f.mesh), 0.0);
  }
}

std::size_t crossingsIn(const FractureResult& result) {
  std::size_t pairs = 0;
  for (const Fragment& f : result.fragments)
    pairs += selfCrossings(f.mesh.vertices, f.mesh.triangles).size();
  return pairs;
}

TEST_F(Resample, CrossesItselfNoMoreThanTheSharedMesh) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    FractureOptions shared = resampleOptions(Interface::shared, seed);
    shared.grow.roughness = 1.5;
    FractureOptions own = shared;
    own.surface.interface = Interface::independent;
    const TriangleMesh torus = rotatedShape(shapes::torus(1.0, 0.3), 0.4, 0.7);
    EXPECT_LE(crossingsIn(fracture(torus, own, device())),
              crossingsIn(fracture(torus, shared, device())))
        << seed;
  }
}

}  // namespace
}  // namespace sherd
