// Attributes that are linear in planes, or not.
#include "mesh/attributes/bent_attributes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "interface/flat_input.h"
#include "shapes.h"
#include "surface/simplify.h"

namespace sherd {
namespace {

// A plate of n * n squares with texture coordinates.
TriangleMesh plate(std::uint32_t n, const std::function<glm::vec2(double, double)>& texcoord) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) mesh.vertices.emplace_back(i, j, 0.0);
  }
  const auto add = [&](glm::uvec3 t) {
    mesh.triangles.push_back(t);
    auto& corners = mesh.attributes.texcoords.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& v = mesh.vertices[t[k]];
      corners[static_cast<std::size_t>(k)] = texcoord(v.x / n, v.y / n);
    }
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t v = i * (n + 1) + j;
      add({v, v + n + 1, v + n + 2});
      add({v, v + n + 2, v + 1});
    }
  }
  return mesh;
}

double bentShare(const TriangleMesh& mesh) { return bentArea(mesh, charts(mesh)) / area(mesh); }

TEST(BentAttributes, AreNoneOfALinearTexture) {
  EXPECT_EQ(bentShare(plate(9, [](double x, double y) { return glm::vec2(2 * x - y, x); })), 0.0);
  TriangleMesh colored = plate(9, [](double, double) { return glm::vec2(0.0f); });
  colored.attributes.texcoords.clear();
  EXPECT_EQ(bentShare(colored), 0.0);
}

TEST(BentAttributes, AreTheTrianglesAtAKinkOfTheTexture) {
  // Twice as fast beyond the middle: the triangles with an edge on it, half of two columns.
  const TriangleMesh mesh =
      plate(10, [](double x, double y) { return glm::vec2(x < 0.5 ? x : 2.0 * x - 0.5, y); });
  EXPECT_NEAR(bentShare(mesh), 0.1, 1e-9);
  // Linear within each square: the triangles in two corners have no other neighbor.
  EXPECT_NEAR(bentShare(plate(10, [](double x, double y) { return glm::vec2(x * x, y * y); })),
              0.99, 1e-9);
}

TEST(BentAttributes, AreThoseOfColorsToo) {
  TriangleMesh mesh = plate(10, [](double, double) { return glm::vec2(0.0f); });
  mesh.attributes.texcoords.clear();
  for (const glm::uvec3& t : mesh.triangles) {
    auto& corners = mesh.attributes.colors.emplace_back();
    for (int k = 0; k < 3; ++k)
      corners[static_cast<std::size_t>(k)] = glm::u8vec3(mesh.vertices[t[k]].x == 5.0 ? 200 : 0);
  }
  EXPECT_NEAR(bentShare(mesh), 0.3, 1e-9);  // the columns beside the line, half of the next ones
}

TEST(BentAttributes, PreventMerging) {
  for (const bool isBent : {false, true}) {
    TriangleMesh cube = shapes::cube(1.0);
    for (const glm::uvec3& t : cube.triangles) {
      auto& corners = cube.attributes.texcoords.emplace_back();
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3& v = cube.vertices[t[k]];
        corners[static_cast<std::size_t>(k)] = isBent ? glm::vec2(v.x * v.y + v.z * v.x, v.y * v.z)
                                                      : glm::vec2(v.x + v.z, v.y + 2 * v.z);
      }
    }
    EXPECT_EQ(isPiecewiseFlat(voxelize(cube, {.resolution = 32})), !isBent);
  }
}

}  // namespace
}  // namespace sherd
