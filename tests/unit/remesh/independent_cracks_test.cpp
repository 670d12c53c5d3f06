// Fragments that are meshed independently: where the vertices of their cracks are.
#include <gtest/gtest.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "kernels/device_fixture.h"
#include "mesh_checks.h"
#include "remesh/resample/crack_jitter.h"
#include "shapes.h"

namespace sherd {
namespace {

using IndependentCracks = DeviceTest;

using FileVertex = std::array<float, 3>;

FileVertex inFile(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

std::vector<bool> areOnCracks(const TriangleMesh& mesh) {
  std::vector<bool> on(mesh.vertices.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; mesh.neighbor[t] != 0 && k < 3; ++k) on[mesh.triangles[t][k]] = true;
  }
  return on;
}

// Of the vertices of cracks: how many there are, how many are another fragment's in a file of
// single precision, and how many have one of another fragment within a twentieth of a voxel.
struct Shared {
  std::size_t all = 0, same = 0, near = 0;
};

Shared sharedIn(const FractureResult& result) {
  const double h = result.solid.frame.voxelSize;
  Shared found;
  for (const Fragment& own : result.fragments) {
    std::set<FileVertex> theirs;
    std::vector<glm::dvec3> at;
    for (const Fragment& other : result.fragments) {
      if (other.id == own.id) continue;
      const std::vector<bool> on = areOnCracks(other.mesh);
      for (std::size_t v = 0; v < on.size(); ++v) {
        theirs.insert(inFile(other.mesh.vertices[v]));
        if (on[v]) at.push_back(other.mesh.vertices[v]);
      }
    }
    std::sort(at.begin(), at.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    const std::vector<bool> on = areOnCracks(own.mesh);
    for (std::size_t v = 0; v < on.size(); ++v) {
      const glm::dvec3& p = own.mesh.vertices[v];
      found.same += theirs.count(inFile(p));
      if (!on[v]) continue;
      ++found.all;
      const double reach = 0.05 * h;
      auto near = std::lower_bound(at.begin(), at.end(), p.x - reach,
                                   [](const glm::dvec3& a, double x) { return a.x < x; });
      while (near != at.end() && near->x <= p.x + reach && glm::length(*near - p) > reach) ++near;
      found.near += near != at.end() && near->x <= p.x + reach;
    }
  }
  return found;
}

FractureOptions optionsFor(std::uint64_t seed) {
  FractureOptions options{.pieces = 6, .seed = seed, .solid = {.resolution = 48}};
  options.surface.interface = Interface::independent;
  return options;
}

double volumeOf(const FractureResult& result) {
  double sum = 0.0;
  for (const Fragment& f : result.fragments) sum += volume(f.mesh);
  return sum;
}

TEST_F(IndependentCracks, SharedOnesHaveTheSameVertices) {
  FractureOptions options = optionsFor(1);
  options.surface.interface = Interface::shared;
  const Shared found = sharedIn(fracture(shapes::ball(1.0), options, device()));
  EXPECT_GT(found.all, 1000u);
  EXPECT_EQ(found.same, found.all);
}

TEST_F(IndependentCracks, NoVertexIsANeighbors) {
  for (const TriangleMesh& mesh :
       {shapes::ball(1.0), shapes::cup(1.0, 0.3, 1.5, 0.3, 64), shapes::cube(1.0)}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      for (const double roughness : {0.0, 1.0}) {
        FractureOptions options = optionsFor(seed);
        options.grow.roughness = roughness;
        const FractureResult result = fracture(mesh, options, device());
        const Shared found = sharedIn(result);
        EXPECT_EQ(found.same, 0u) << seed;
        EXPECT_GT(found.all, 20u);
        for (const Fragment& f : result.fragments) {
          expectClosedManifold(f.mesh);
          EXPECT_EQ(meshComponents(f.mesh).count, 1u);
        }
      }
    }
  }
}

TEST_F(IndependentCracks, TheTwoSidesAreSampledAtDifferentPoints) {
  // Points that had nothing to do with each other, one for each square voxel of a plane, are within
  // a twentieth of a voxel of one of the other side in pi / 400 of all cases; on contact
  // boundaries, one for each voxel, in a tenth; corners always.
  for (const TriangleMesh& mesh : {shapes::ball(1.0), shapes::cup(1.0, 0.3, 1.5, 0.3, 64)}) {
    Shared sum;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Shared found = sharedIn(fracture(mesh, optionsFor(seed), device()));
      sum.all += found.all;
      sum.near += found.near;
    }
    EXPECT_LT(static_cast<double>(sum.near), 0.1 * static_cast<double>(sum.all));
  }
}

TEST_F(IndependentCracks, VolumesStay) {
  // Vertices are points of the surface, so a volume changes by what chords cut off.
  for (const TriangleMesh& mesh : {shapes::ball(1.0), shapes::cup(1.0, 0.3, 1.5, 0.3, 64)}) {
    FractureOptions options = optionsFor(2);
    const FractureResult independent = fracture(mesh, options, device());
    options.surface.interface = Interface::shared;
    const FractureResult shared = fracture(mesh, options, device());
    EXPECT_NEAR(volumeOf(independent) / volumeOf(shared), 1.0, 0.0025);
    for (std::size_t i = 0; i < shared.fragments.size(); ++i) {
      EXPECT_NEAR(volume(independent.fragments[i].mesh) / volume(shared.fragments[i].mesh), 1.0,
                  0.01);
    }
  }
}

TEST_F(IndependentCracks, DependOnTheSeedAlone) {
  const TriangleMesh ball = shapes::ball(1.0);
  const FractureResult one = fracture(ball, optionsFor(4), device());
  const FractureResult again = fracture(ball, optionsFor(4), device());
  for (std::size_t i = 0; i < one.fragments.size(); ++i) {
    EXPECT_EQ(one.fragments[i].mesh.vertices, again.fragments[i].mesh.vertices);
  }
  const FractureResult other = fracture(ball, optionsFor(5), device());
  EXPECT_NE(one.fragments[0].mesh.vertices, other.fragments[0].mesh.vertices);
}

TEST_F(IndependentCracks, AMovedInputMovesThem) {
  TriangleMesh ball = shapes::ball(1.0);
  const FractureResult before = fracture(ball, optionsFor(5), device());
  for (glm::dvec3& v : ball.vertices) v = 4.0 * v + glm::dvec3(64.0, -32.0, 16.0);
  const FractureResult after = fracture(ball, optionsFor(5), device());
  for (std::size_t i = 0; i < before.fragments.size(); ++i) {
    const std::vector<glm::dvec3>& a = before.fragments[i].mesh.vertices;
    const std::vector<glm::dvec3>& b = after.fragments[i].mesh.vertices;
    ASSERT_EQ(a.size(), b.size());
    double most = 0.0;
    for (std::size_t v = 0; v < a.size(); ++v) {
      most = std::max(most, glm::length(4.0 * a[v] + glm::dvec3(64.0, -32.0, 16.0) - b[v]));
    }
    EXPECT_LT(most, 1e-9);
  }
}

TEST_F(IndependentCracks, DecimatedMeshesShareNone) {
  FractureOptions options = optionsFor(6);
  options.surface.triangles = {100};
  FractureResult result = fracture(shapes::ball(1.0), options, device());
  for (Fragment& f : result.fragments) f.mesh = f.coarse.at(0);
  EXPECT_EQ(sharedIn(result).same, 0u);
}

TEST_F(IndependentCracks, SmallVoidsOfTheSolidAreLeftOut) {
  // Voids of 2 and 6 voxels across: below and above 27 voxels.
  for (const auto& [radius, surfaces] : {std::pair{1.0, 1u}, std::pair{3.0, 2u}}) {
    FractureOptions options = optionsFor(7);
    options.pieces = 1;
    const TriangleMesh ball = shapes::hollowBall(1.0, radius * 2.0 / 48.0);
    EXPECT_EQ(meshComponents(fracture(ball, options, device()).fragments[0].mesh).count, surfaces);
    options.surface.interface = Interface::shared;
    EXPECT_EQ(meshComponents(fracture(ball, options, device()).fragments[0].mesh).count, 2u);
  }
}

}  // namespace
}  // namespace sherd
