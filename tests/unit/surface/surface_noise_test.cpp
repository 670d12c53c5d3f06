// Noise on the surfaces of fragments: what moves, by how much, and what stays.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <utility>
#include <vector>

#include "shapes.h"

namespace sherd {
namespace {

FractureResult noisy(const TriangleMesh& mesh, double mismatch, double common = 0.0,
                     double scan = 0.0, Surface surface = Surface::smooth) {
  Device device("builtin");
  FractureOptions options{.pieces = 6, .seed = 5, .solid = {.resolution = 64}};
  options.surface.surface = surface;
  options.surface.adaptivity = 0.0;
  options.surface.mismatch.rms = mismatch;
  options.surface.mismatchCommon = common;
  options.surface.scanNoise.rms = scan;
  options.surface.triangles = {400};
  return fracture(mesh, options, device);
}

// The neighbors of the faces of each vertex.
std::vector<std::vector<std::uint16_t>> neighborsAt(const TriangleMesh& mesh) {
  std::vector<std::vector<std::uint16_t>> at(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) at[mesh.triangles[t][k]].push_back(mesh.neighbor[t]);
  }
  return at;
}

bool isWithinContact(const std::vector<std::uint16_t>& neighbors) {
  for (const std::uint16_t id : neighbors) {
    if (id == 0 || id != neighbors.front()) return false;
  }
  return !neighbors.empty();
}

double diagonal(const TriangleMesh& mesh) {
  const Box box = bounds(mesh);
  return glm::length(box.max - box.min);
}

TEST(SurfaceNoise, MovesVerticesWithinContactsAndNoOther) {
  for (const Surface surface : {Surface::smooth, Surface::exact}) {
    const TriangleMesh ball = shapes::ball(1.0, 4);
    const FractureResult plain = noisy(ball, 0.0, 0.0, 0.0, surface);
    const FractureResult moved = noisy(ball, 0.15, 0.0, 0.0, surface);
    ASSERT_EQ(plain.fragments.size(), moved.fragments.size());
    for (std::size_t i = 0; i < plain.fragments.size(); ++i) {
      const TriangleMesh& before = plain.fragments[i].mesh;
      const TriangleMesh& after = moved.fragments[i].mesh;
      ASSERT_EQ(before.triangles, after.triangles);
      EXPECT_EQ(before.neighbor, after.neighbor);
      EXPECT_EQ(openEdges(after), 0u);
      const auto neighbors = neighborsAt(before);
      std::size_t changed = 0, within = 0;
      for (std::size_t v = 0; v < before.vertices.size(); ++v) {
        if (!isWithinContact(neighbors[v])) {
          EXPECT_EQ(before.vertices[v], after.vertices[v]);
        } else {
          ++within;
          if (before.vertices[v] != after.vertices[v]) ++changed;
        }
      }
      EXPECT_GT(within, 50u);
      EXPECT_EQ(changed, within);
      EXPECT_EQ(openEdges(moved.fragments[i].coarse.front()), 0u);
    }
  }
}

// Of vertices at least three voxels from every boundary: where nothing is left of the fading.
std::pair<double, std::size_t> squaredMoves(const Fragment& before, const Fragment& after,
                                            double margin) {
  const auto neighbors = neighborsAt(before.mesh);
  std::vector<glm::dvec3> boundary;
  for (std::size_t v = 0; v < neighbors.size(); ++v) {
    if (!isWithinContact(neighbors[v])) boundary.push_back(before.mesh.vertices[v]);
  }
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t v = 0; v < neighbors.size(); ++v) {
    const glm::dvec3& at = before.mesh.vertices[v];
    bool isFar = isWithinContact(neighbors[v]);
    for (std::size_t b = 0; isFar && b < boundary.size(); ++b) {
      isFar = glm::distance(boundary[b], at) > margin;
    }
    if (!isFar) continue;
    const glm::dvec3 by = after.mesh.vertices[v] - at;
    sum += glm::dot(by, by);
    ++count;
  }
  return {sum, count};
}

TEST(SurfaceNoise, HasTheRmsAskedForAwayFromBoundaries) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const FractureResult plain = noisy(ball, 0.0), moved = noisy(ball, 0.2);
  const double voxel = plain.solid.frame.voxelSize;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < plain.fragments.size(); ++i) {
    const auto [squares, vertices] =
        squaredMoves(plain.fragments[i], moved.fragments[i], 3.0 * voxel);
    sum += squares, count += vertices;
  }
  // Some 30 contacts' sides of about 40 patches of independent heights: the rms of 1,200 is known
  // to 1 / sqrt(2,400), of which 0.08 is four.
  ASSERT_GT(count, 5000u);
  const double rms = std::sqrt(sum / static_cast<double>(count));
  EXPECT_NEAR(rms / (0.002 * diagonal(ball)), 1.0, 0.08);
}

std::size_t turnedOver(const TriangleMesh& before, const TriangleMesh& after) {
  const auto normal = [](const TriangleMesh& mesh, const glm::uvec3& t) {
    return glm::cross(mesh.vertices[t.y] - mesh.vertices[t.x],
                      mesh.vertices[t.z] - mesh.vertices[t.x]);
  };
  return static_cast<std::size_t>(std::count_if(
      before.triangles.begin(), before.triangles.end(),
      [&](const glm::uvec3& t) { return glm::dot(normal(before, t), normal(after, t)) < 0.0; }));
}

// Meshes of independent interfaces have vertices that are closer than the noise moves them.
TEST(SurfaceNoise, TurnsNoTriangleOver) {
  Device device("builtin");
  FractureOptions options{.pieces = 6, .seed = 5, .solid = {.resolution = 48}};
  options.surface.surface = Surface::smooth;
  options.surface.interface = Interface::independent;
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const FractureResult plain = fracture(ball, options, device);
  for (const auto& [mismatch, scan] : {std::pair(0.3, 0.0), std::pair(0.0, 0.1)}) {
    options.surface.mismatch.rms = mismatch;
    options.surface.scanNoise.rms = scan;
    const FractureResult moved = fracture(ball, options, device);
    for (std::size_t i = 0; i < plain.fragments.size(); ++i) {
      EXPECT_EQ(turnedOver(plain.fragments[i].mesh, moved.fragments[i].mesh), 0u)
          << mismatch << ", " << scan << ", " << i;
    }
  }
}

// The positions of vertices within contacts: by neighbor pair, before and after.
using Sides = std::map<std::pair<int, int>, std::map<std::array<double, 3>, glm::dvec3>>;

Sides sidesOf(const FractureResult& before, const FractureResult& after) {
  Sides sides;
  for (std::size_t i = 0; i < before.fragments.size(); ++i) {
    const TriangleMesh& mesh = before.fragments[i].mesh;
    const auto neighbors = neighborsAt(mesh);
    for (std::size_t v = 0; v < neighbors.size(); ++v) {
      if (!isWithinContact(neighbors[v])) continue;
      const glm::dvec3& at = mesh.vertices[v];
      sides[{before.fragments[i].id, neighbors[v].front()}][{at.x, at.y, at.z}] =
          after.fragments[i].mesh.vertices[v];
    }
  }
  return sides;
}

TEST(SurfaceNoise, SidesMoveAlikeAsFarAsTheNoiseIsCommon) {
  const TriangleMesh cube = shapes::cube(2.0);
  const FractureResult plain = noisy(cube, 0.0);
  for (const double common : {0.0, 0.5, 1.0}) {
    const FractureResult moved = noisy(cube, 0.15, common);
    const Sides sides = sidesOf(plain, moved);
    double apart = 0.0, moves = 0.0, count = 0.0;
    for (const auto& [ids, vertices] : sides) {
      if (ids.first > ids.second) continue;
      const auto& others = sides.at({ids.second, ids.first});
      ASSERT_EQ(vertices.size(), others.size());
      for (const auto& [at, position] : vertices) {
        const glm::dvec3 gap = position - others.at(at);
        const glm::dvec3 by = position - glm::dvec3(at[0], at[1], at[2]);
        apart += glm::dot(gap, gap), moves += glm::dot(by, by), count += 1.0;
      }
    }
    ASSERT_GT(count, 3000.0);
    // The variance of a difference of heights with this correlation, of some 400 patches.
    EXPECT_NEAR(apart / moves, 2.0 * (1.0 - common), common == 1.0 ? 1e-20 : 0.25) << common;
  }
}

TEST(SurfaceNoise, LabelsLevelSetsAndContactsStay) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  const FractureResult plain = noisy(ball, 0.0), moved = noisy(ball, 0.3, 0.0, 0.2);
  EXPECT_EQ(plain.labels.fragment, moved.labels.fragment);
  for (std::size_t i = 0; i < plain.fragments.size(); ++i) {
    const Fragment &a = plain.fragments[i], &b = moved.fragments[i];
    ASSERT_EQ(a.contacts.size(), b.contacts.size());
    for (std::size_t k = 0; k < a.contacts.size(); ++k) {
      EXPECT_EQ(a.contacts[k].fragment, b.contacts[k].fragment);
      EXPECT_EQ(a.contacts[k].area, b.contacts[k].area);
    }
    EXPECT_NE(a.mass.volume, b.mass.volume);
    EXPECT_NEAR(b.mass.volume, volume(b.mesh), 1e-12);  // another sum of the same terms
  }
}

TEST(SurfaceNoise, OfScansMovesEveryVertex) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const FractureResult plain = noisy(ball, 0.0), moved = noisy(ball, 0.0, 0.0, 0.1);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < plain.fragments.size(); ++i) {
    const TriangleMesh& before = plain.fragments[i].mesh;
    const TriangleMesh& after = moved.fragments[i].mesh;
    EXPECT_EQ(openEdges(after), 0u);
    for (std::size_t v = 0; v < before.vertices.size(); ++v) {
      const glm::dvec3 by = after.vertices[v] - before.vertices[v];
      EXPECT_NE(glm::dot(by, by), 0.0);
      sum += glm::dot(by, by), count += 1.0;
    }
  }
  EXPECT_NEAR(std::sqrt(sum / count) / (0.001 * diagonal(ball)), 1.0, 0.08);
}

TEST(SurfaceNoise, IsRefusedWhereItCannotBe) {
  const TriangleMesh cube = shapes::cube(1.0);
  EXPECT_THROW((void)noisy(cube, 0.0, 0.0, 0.1, Surface::exact), Error);
  EXPECT_THROW((void)noisy(cube, 6.0), Error);
  EXPECT_THROW((void)noisy(cube, 0.1, 1.5), Error);
  EXPECT_EQ(noisy(cube, 0.0, 0.0, 0.1, Surface::automatic).fragments.front().meshedAs,
            Surface::smooth);
}

}  // namespace
}  // namespace sherd
