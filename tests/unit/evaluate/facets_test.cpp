// Faces of rough cracks.
#include <gtest/gtest.h>
#include <sherd/evaluate.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "shapes.h"

namespace sherd {
namespace {

/// A self-affine relief with an exponent of 0.8 on a square of side 1: a sum of random waves.
class Relief {
 public:
  explicit Relief(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    double squares = 0.0;
    for (int i = -kMostWaves; i <= kMostWaves; ++i) {
      for (int k = 0; k <= kMostWaves; ++k) {
        if (k == 0 && i <= 0) continue;
        const double amplitude = normal(random) * std::pow(std::hypot(i, k), -1.8);
        waves_.push_back({std::numbers::pi * glm::dvec2(i, k), phase(random), amplitude});
        squares += 0.5 * amplitude * amplitude;
      }
    }
    for (Wave& wave : waves_) wave.amplitude /= std::sqrt(squares);
  }

  /// Heights have an rms of about 1.
  double at(glm::dvec2 p) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) {
      sum += wave.amplitude * std::cos(wave.k.x * p.x + wave.k.y * p.y + wave.phase);
    }
    return sum;
  }

 private:
  static constexpr int kMostWaves = 16;
  struct Wave {
    glm::dvec2 k;
    double phase, amplitude;
  };
  std::vector<Wave> waves_;
};

// A box whose sides are grids; the first of them, in the order x = 0, y = 0, z = 0, x = 1, ..., are
// cracks with relief, each towards a neighbor of its own.
//   rms  of a unit square
TriangleMesh roughBox(glm::ivec3 size, int cracks, double rms, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  TriangleMesh mesh;
  std::map<std::array<int, 3>, unsigned> indices;
  std::vector<glm::ivec3> positions;
  const auto vertex = [&](glm::ivec3 p) {
    const auto [known, isNew] = indices.try_emplace({p.x, p.y, p.z}, positions.size());
    if (isNew) positions.push_back(p);
    return known->second;
  };
  for (int side = 0; side < 6; ++side) {
    const int axis = side % 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int a = 0; a < size[u]; ++a) {
      for (int b = 0; b < size[v]; ++b) {
        const auto at = [&](int i, int k) {
          glm::ivec3 p(0);
          p[axis] = side < 3 ? 0 : size[axis];
          p[u] = a + i;
          p[v] = b + k;
          return vertex(p);
        };
        glm::uvec3 one(at(0, 0), at(1, 0), at(1, 1)), two(at(0, 0), at(1, 1), at(0, 1));
        if (side < 3) {
          std::swap(one.y, one.z);
          std::swap(two.y, two.z);
        }
        mesh.triangles.push_back(one);
        mesh.triangles.push_back(two);
        mesh.neighbor.insert(mesh.neighbor.end(), 2,
                             static_cast<std::uint16_t>(side < cracks ? side + 2 : 0));
      }
    }
  }
  for (const glm::ivec3& p : positions) mesh.vertices.emplace_back(p);
  for (int side = 0; side < cracks; ++side) {
    const int axis = side % 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Relief relief(random);
    const double length = std::sqrt(double(size[u]) * size[v]);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const glm::dvec3 p(positions[i]);
      if (positions[i][axis] != (side < 3 ? 0 : size[axis])) continue;
      mesh.vertices[i][axis] += rms * length * relief.at(glm::dvec2(p[u], p[v]) / length);
    }
  }
  return mesh;
}

std::size_t facesOf(const TriangleMesh& mesh, std::optional<FaceRule> rule = {}) {
  FragmentSet set;
  set.fragments.resize(1);
  set.fragments[0].mesh = {1, mesh};
  const FractureStatistics found = statistics(set, {.faces = rule, .unit = 1.0, .simulations = 20});
  EXPECT_EQ(found.rule, FaceRule::facets);
  return found.fragments[0].faces;
}

TEST(Facets, AreAsManyAsTheRoughSidesOfACube) {
  for (int cracks = 1; cracks <= 6; ++cracks) {
    for (const double rms : {0.02, 0.04}) {
      for (const std::uint64_t seed : {1u, 2u, 3u}) {
        EXPECT_EQ(facesOf(roughBox({32, 32, 32}, cracks, rms, seed)),
                  static_cast<std::size_t>(cracks))
            << rms << ", seed " << seed;
      }
    }
  }
}

// A sherd of a plate: narrow cracks on its sides.
TEST(Facets, OfAPlateAreItsSides) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const TriangleMesh sherd = roughBox({48, 48, 8}, 2, 0.03, seed);
    EXPECT_EQ(facesOf(sherd), 2u) << seed;
  }
}

// One crack that two neighbors share is one face, as a hand draws it.
TEST(Facets, MayHaveTwoNeighbors) {
  TriangleMesh mesh = roughBox({32, 32, 32}, 1, 0.03, 4);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::dvec3& corner = mesh.vertices[mesh.triangles[t].x];
    if (mesh.neighbor[t] != 0 && corner.y > 16.0) mesh.neighbor[t] = 9;
  }
  EXPECT_EQ(facesOf(mesh), 1u);
}

// Planes that no relief bends are facets too, where they are asked for.
TEST(Facets, OfACubeAreItsSides) {
  TriangleMesh cube = roughBox({4, 4, 4}, 6, 0.0, 1);
  EXPECT_EQ(facesOf(cube, FaceRule::facets), 6u);
}

}  // namespace
}  // namespace sherd
