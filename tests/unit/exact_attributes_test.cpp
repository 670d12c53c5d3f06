// Surface::exact: normals of the input in the fragments.
#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/fracture.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "appearance/transfer.h"
#include "shapes.h"

namespace sherd {
namespace {

FractureResult broken(const TriangleMesh& mesh, int pieces) {
  FractureOptions options;
  options.pieces = pieces;
  options.seed = 7;
  options.solid.resolution = 40;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  Device device("builtin");
  FractureResult result = fracture(mesh, options, device);
  EXPECT_EQ(result.exactFailure, "");
  return result;
}

// Gives the corners unit vectors that have nothing to do with the surface, other ones on each side.
void addNormals(TriangleMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<glm::vec3, 3>& corners = mesh.attributes.normals.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = 0.9 * mesh.triangles[t][static_cast<int>(k)] + static_cast<double>(t / 2);
      corners[k] = glm::vec3(glm::normalize(glm::dvec3(std::cos(a), std::sin(a), 0.4)));
    }
  }
}

// The place of a point in a triangle, by areas.
glm::dvec3 areaWeights(const glm::dvec3& p, const std::array<glm::dvec3, 3>& c) {
  const auto areaOf = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& d) {
    return glm::length(glm::cross(b - a, d - a));
  };
  const glm::dvec3 areas(areaOf(p, c[1], c[2]), areaOf(c[0], p, c[2]), areaOf(c[0], c[1], p));
  return areas / (areas[0] + areas[1] + areas[2]);
}

// Compares a fragment's normals with those of `mesh`; `sign` of each triangle.
// Returns how many corners are the input's.
std::size_t expectNormals(const TriangleMesh& mesh, const TriangleMesh& fragment,
                          const SurfaceAttributes& found, const std::vector<float>& sign) {
  std::size_t same = 0;
  for (std::size_t t = 0; t < fragment.triangles.size(); ++t) {
    const std::uint32_t from = fragment.source[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3& normal = found.normals[t][k];
      if (from == TriangleMesh::kNoSource) {
        EXPECT_EQ(normal, glm::vec3(0.0f));
        continue;
      }
      const glm::dvec3 p = fragment.vertices[fragment.triangles[t][static_cast<int>(k)]];
      const std::array<glm::vec3, 3>& given = mesh.attributes.normals[from];
      std::array<glm::dvec3, 3> whole{};
      for (std::size_t c = 0; c < 3; ++c) {
        whole[c] = mesh.vertices[mesh.triangles[from][static_cast<int>(c)]];
        if (whole[c] != p) continue;
        ++same;
        EXPECT_EQ(normal, sign[from] * given[c]);
      }
      const glm::dvec3 weights = areaWeights(p, whole);
      const glm::dvec3 mean = weights[0] * glm::dvec3(given[0]) +
                              weights[1] * glm::dvec3(given[1]) + weights[2] * glm::dvec3(given[2]);
      const glm::dvec3 expected = static_cast<double>(sign[from]) * glm::normalize(mean);
      EXPECT_LT(glm::distance(glm::dvec3(normal), expected), 1e-6);
    }
  }
  return same;
}

TEST(ExactAttributes, NormalsAreTheInputsAndUnitBetween) {
  TriangleMesh mesh = shapes::cube(2.0, {0.1, 0.2, 0.3});
  addNormals(mesh);
  const std::vector<float> sign(mesh.triangles.size(), 1.0f);
  const AttributeSource source(mesh);
  std::size_t same = 0;
  for (const Fragment& fragment : broken(mesh, 5).fragments) {
    const SurfaceAttributes own = source.transferTo(fragment.mesh, 0);
    EXPECT_TRUE(own.hasOnlyNormals());
    same += expectNormals(mesh, fragment.mesh, own, sign);
  }
  EXPECT_GT(same, 20u);
}

TEST(ExactAttributes, FlippedTrianglesHaveFlippedNormals) {
  TriangleMesh mesh = shapes::ball(1.0, 2);
  addNormals(mesh);
  std::vector<float> sign(mesh.triangles.size(), 1.0f);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 5) {
    std::swap(mesh.triangles[t].y, mesh.triangles[t].z);
    sign[t] = -1.0f;
  }
  const AttributeSource source(mesh);
  for (const Fragment& fragment : broken(mesh, 6).fragments) {
    expectNormals(mesh, fragment.mesh, source.transferTo(fragment.mesh, 0), sign);
  }
}

TEST(ExactAttributes, SmoothSurfacesHaveNoneOfTheInputsNormals) {
  TriangleMesh mesh = shapes::cube(2.0);
  addNormals(mesh);
  EXPECT_TRUE(AttributeSource(mesh).transferTo(shapes::cube(2.0), 0).empty());
  mesh.attributes.material.assign(12, 0);
  const SurfaceAttributes own = AttributeSource(mesh).transferTo(shapes::cube(2.0), 0);
  EXPECT_TRUE(own.normals.empty());
  EXPECT_EQ(own.material.size(), 12u);
}

}  // namespace
}  // namespace sherd
