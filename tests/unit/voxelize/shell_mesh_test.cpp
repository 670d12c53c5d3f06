// Sheets with a thickness, as closed meshes.
#include "voxelize/shell_mesh.h"

#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "intersect/self_crossings.h"
#include "mesh/edges.h"
#include "shapes.h"

namespace sherd {
namespace {

// Squares of side 1 on a plane of points (u, v), bent by a function of u and v.
template <class Bend>
TriangleMesh sheet(int columns, int rows, Bend bend) {
  TriangleMesh mesh;
  for (int i = 0; i <= columns; ++i) {
    for (int j = 0; j <= rows; ++j) mesh.vertices.push_back(bend(i, j));
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (rows + 1) + j); };
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return mesh;
}

SolidMesh sourced(TriangleMesh mesh) {
  SolidMesh out;
  out.mesh = std::move(mesh);
  for (std::uint32_t t = 0; t < out.mesh.triangles.size(); ++t) out.source.push_back(t);
  return out;
}

SolidMesh shellOf(const TriangleMesh& mesh, double thickness) {
  SolidMesh shell = shellMesh(sourced(mesh), thickness);
  EXPECT_EQ(edgeDefects(shell.mesh).unbalanced, 0u);
  EXPECT_EQ(shell.source.size(), shell.mesh.triangles.size());
  return shell;
}

TEST(ShellMesh, OfASquareIsABox) {
  const TriangleMesh square = sheet(2, 2, [](int i, int j) { return glm::dvec3(i, j, 0.0); });
  const SolidMesh shell = shellOf(square, 0.25);
  EXPECT_DOUBLE_EQ(volume(shell.mesh), 1.0);
  EXPECT_EQ(shell.mesh.triangles.size(), 8u + 8u + 16u);
  std::map<std::uint32_t, int> parts;  // of each triangle: two sides, and two faces at open edges
  for (const std::uint32_t source : shell.source) ++parts[source];
  EXPECT_EQ(parts.size(), square.triangles.size());
  for (std::uint32_t t = 0; t < 8; ++t) {
    int open = 0;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 middle = 0.5 * (square.vertices[square.triangles[t][k]] +
                                       square.vertices[square.triangles[t][(k + 1) % 3]]);
      open += middle.x == 0.0 || middle.x == 2.0 || middle.y == 0.0 || middle.y == 2.0;
    }
    EXPECT_EQ(parts[t], 2 + 2 * open);
  }
  EXPECT_TRUE(selfCrossings(shell.mesh.vertices, shell.mesh.triangles).empty());
}

TEST(ShellMesh, OfAFoldIsMitered) {
  const TriangleMesh fold = sheet(2, 1, [](int i, int j) {
    return i == 0 ? glm::dvec3(-1.0, j, 0.0) : glm::dvec3(0.0, j, i == 1 ? 0.0 : 1.0);
  });
  const SolidMesh shell = shellOf(fold, 0.25);
  EXPECT_NEAR(volume(shell.mesh), 2.0 * 0.25, 1e-12);  // an L of constant width
  EXPECT_TRUE(selfCrossings(shell.mesh.vertices, shell.mesh.triangles).empty());
}

// Where two sheets have less than 60 degrees between them, their miter is cut off: towards the fold
// they get thinner.
TEST(ShellMesh, OfASharpFoldIsThinnerAtTheFold) {
  for (const double degrees : {80.0, 60.5, 59.5, 40.0}) {
    const double half = degrees / 2.0 * std::numbers::pi / 180.0;
    const TriangleMesh fold = sheet(2, 1, [&](int i, int j) {
      return glm::dvec3(i == 1 ? 0.0 : std::cos(half), (i - 1) * std::sin(half), j);
    });
    const double thickness = 0.125;
    const SolidMesh shell = shellOf(fold, thickness);
    // The section of each sheet is a trapezoid, as long as the sheet.
    const double atFold = thickness * std::min(1.0, kMostMiter * std::sin(half));
    EXPECT_NEAR(volume(shell.mesh), 2.0 * (thickness + atFold) / 2.0, 1e-12) << degrees;
    EXPECT_TRUE(selfCrossings(shell.mesh.vertices, shell.mesh.triangles).empty()) << degrees;
  }
}

TEST(ShellMesh, OfAClosedMeshIsHollow) {
  const SolidMesh shell = shellOf(shapes::cube(2.0), 0.5);
  EXPECT_NEAR(volume(shell.mesh), 2.5 * 2.5 * 2.5 - 1.5 * 1.5 * 1.5, 1e-12);
}

TEST(ShellMesh, OfThreeSheetsAtAnEdgeIsClosedAndCrossesItself) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 0, 1}};
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 3.0;
    mesh.vertices.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    mesh.triangles.emplace_back(0, 1, 2 + k);
  }
  const SolidMesh shell = shellOf(mesh, 0.1);
  EXPECT_NEAR(volume(shell.mesh), 3 * 0.5 * 0.1, 1e-12);
  EXPECT_FALSE(selfCrossings(shell.mesh.vertices, shell.mesh.triangles).empty());
}

// A sheet without a volume is broken as a shell with both of its sides, bent by less than its
// thickness.
TEST(ShellMesh, IsCutExactly) {
  const TriangleMesh wave =
      sheet(20, 16, [](int i, int j) { return glm::dvec3(i, j, std::sin(0.4 * i + 0.2 * j)); });
  Device device("builtin");
  for (const double roughness : {0.0, 1.0}) {
    FractureOptions options;
    options.pieces = 7;
    options.seed = 3;
    options.solid.resolution = 64;
    options.solid.keepMesh = true;
    options.grow.roughness = roughness;
    options.surface = {.levelSets = false, .surface = Surface::exact};
    const FractureResult result = fracture(wave, options, device);
    EXPECT_EQ(result.solid.report.fill, Fill::shell);
    ASSERT_EQ(result.exactFailure, "");
    const SolidMesh shell = shellOf(wave, result.solid.report.shellThickness);
    double sum = 0.0;
    for (const Fragment& fragment : result.fragments) {
      EXPECT_EQ(fragment.meshedAs, Surface::exact);
      EXPECT_EQ(edgeDefects(fragment.mesh).unbalanced, 0u);
      EXPECT_EQ(edgeDefects(fragment.mesh).nonManifold, 0u);
      EXPECT_EQ(meshComponents(fragment.mesh).count, 1u);
      EXPECT_TRUE(selfCrossings(fragment.mesh.vertices, fragment.mesh.triangles).empty());
      sum += volume(fragment.mesh);
    }
    EXPECT_NEAR(sum, volume(shell.mesh), 1e-9 * sum);
  }
}

}  // namespace
}  // namespace sherd
