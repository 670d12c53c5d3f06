// Sheets that meshes have from both sides, as leaves and cards.
#include "mesh/repair/sheets.h"

#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/error.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "mesh/repair/repair.h"
#include "shapes.h"

namespace sherd {
namespace {

enum class Back { sameTriangles, otherDiagonal };

// Adds a quad from both sides.
void addCard(TriangleMesh& mesh, const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v,
             Back back) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {corner, corner + u, corner + u + v, corner + v});
  mesh.triangles.insert(mesh.triangles.end(),
                        {first + glm::uvec3(0, 1, 2), first + glm::uvec3(0, 2, 3)});
  if (back == Back::sameTriangles) {
    mesh.triangles.insert(mesh.triangles.end(),
                          {first + glm::uvec3(2, 1, 0), first + glm::uvec3(3, 2, 0)});
  } else {
    mesh.triangles.insert(mesh.triangles.end(),
                          {first + glm::uvec3(3, 2, 1), first + glm::uvec3(3, 1, 0)});
  }
}

constexpr double kLeafArea = 0.3 * 0.5;

// A trunk of 0.4 x 0.4 x 4, and leaves around it, none of which touches another.
TriangleMesh tree(int leaves, Back back) {
  TriangleMesh mesh = shapes::box({0.4, 4.0, 0.4});
  for (int k = 0; k < leaves; ++k) {
    const double angle = 2.4 * k, c = std::cos(angle), s = std::sin(angle);
    const glm::dvec3 out(c, 0.3, s), across(-s, 0.0, c);
    addCard(mesh, {0.7 * c, -1.8 + 3.5 * k / leaves, 0.7 * s}, 0.5 * glm::normalize(out),
            0.3 * across, back);
  }
  return mesh;
}

double volumeOf(const Solid& solid) {
  return static_cast<double>(solid.voxels) * std::pow(solid.frame.voxelSize, 3);
}

FractureResult broken(const TriangleMesh& mesh, Surface surface, SolidOptions solid) {
  FractureOptions options;
  options.solid = solid;
  options.pieces = 4;
  options.surface = {.levelSets = false, .surface = surface};
  Device device("builtin");
  return fracture(mesh, options, device);
}

double meshVolume(const FractureResult& result) {
  double sum = 0.0;
  for (const Fragment& fragment : result.fragments) sum += volume(fragment.mesh);
  return sum;
}

TEST(Sheets, OfLeavesBecomeShellsBesideASolidTrunk) {
  constexpr int kLeaves = 20;
  const double thickness = 0.08, expected = 0.4 * 0.4 * 4.0 + kLeaves * kLeafArea * thickness;
  for (const Back back : {Back::sameTriangles, Back::otherDiagonal}) {
    const TriangleMesh mesh = tree(kLeaves, back);
    for (const Surface surface : {Surface::exact, Surface::smooth}) {
      const FractureResult result = broken(
          mesh, surface, {.voxelSize = 0.025, .fill = Fill::winding, .shellThickness = thickness});
      const SolidReport& report = result.solid.report;
      EXPECT_EQ(report.defects.sheetTriangles, 4u * kLeaves);
      EXPECT_DOUBLE_EQ(report.sheetThickness, thickness);
      EXPECT_EQ(report.fill, Fill::winding);
      EXPECT_EQ(result.fragments.size(), 1u + kLeaves) << "the trunk, and each leaf";
      // A voxel along the surface of some 3 and 20 * 0.4 counts or not by its center.
      EXPECT_NEAR(meshVolume(result), expected, surface == Surface::exact ? 1e-9 : 0.02 * expected);
    }
  }
}

TEST(Sheets, HaveTheThicknessOfShellsByDefault) {
  const Solid solid = voxelize(tree(20, Back::sameTriangles), {.voxelSize = 0.02});
  EXPECT_DOUBLE_EQ(solid.report.sheetThickness, 2.5 * 0.02);
  EXPECT_NEAR(volumeOf(solid) / (0.64 + 20 * kLeafArea * 0.05), 1.0, 0.03);
}

TEST(Sheets, OfCrossedCardsAloneAreASolid) {
  for (const Back back : {Back::sameTriangles, Back::otherDiagonal}) {
    TriangleMesh grass;
    addCard(grass, {-1, 0, 0}, {2, 0, 0}, {0, 1, 0}, back);
    addCard(grass, {0, 0, -1}, {0, 0, 2}, {0, 1, 0}, back);
    const double t = 0.11, expected = 2 * 2.0 * t - t * t;  // the middle is in both
    for (const Surface surface : {Surface::exact, Surface::smooth}) {
      const FractureResult result =
          broken(grass, surface, {.voxelSize = 0.02, .fill = Fill::winding, .shellThickness = t});
      EXPECT_EQ(result.fragments.size(), 4u);
      EXPECT_NEAR(meshVolume(result) / expected, 1.0, surface == Surface::exact ? 1e-9 : 0.02);
      for (const Fragment& fragment : result.fragments) EXPECT_EQ(openEdges(fragment.mesh), 0u);
    }
    // The centers of two layers of voxels are within 1.25 voxels of each card.
    EXPECT_EQ(voxelize(grass, {.resolution = 64}).voxels, 2 * 64u * 32u * 2u - 32u * 2u * 2u);
  }
}

// A curved sheet is one shell, whichever side of each of its faces comes first.
TEST(Sheets, OfManyFacesAreOneShell) {
  TriangleMesh flag;
  constexpr int kColumns = 12;
  std::vector<glm::uvec3> fronts;
  for (int i = 0; i <= kColumns; ++i) {
    const double x = 0.2 * i, y = 0.1 * std::sin(2.0 * x);
    flag.vertices.insert(flag.vertices.end(), {{x, y, 0.0}, {x, y, 1.0}});
  }
  double area = 0.0;
  for (std::uint32_t i = 0; i < kColumns; ++i) {
    const std::uint32_t a = 2 * i, b = a + 1, c = a + 2, d = a + 3;
    for (const glm::uvec3& front : {glm::uvec3(a, b, d), glm::uvec3(a, d, c)}) {
      const glm::uvec3 behind(front.z, front.y, front.x);
      flag.triangles.push_back(i % 3 == 0 ? behind : front);
      flag.triangles.push_back(i % 3 == 0 ? front : behind);
    }
    area += glm::length(flag.vertices[c] - flag.vertices[a]);
  }
  const double thickness = 0.06;
  const FractureResult result =
      broken(flag, Surface::exact,
             {.voxelSize = 0.02, .fill = Fill::winding, .shellThickness = thickness});
  // Mitered joints: what a fold adds outside it lacks inside.
  EXPECT_NEAR(meshVolume(result) / (area * thickness), 1.0, 1e-3);
  EXPECT_EQ(result.united.before, 0u) << "faces are connected";
}

// Each side of an exact shell shows the triangle of the input that is on that side.
TEST(Sheets, KeepTheTrianglesOfBothSides) {
  for (const Back back : {Back::sameTriangles, Back::otherDiagonal}) {
    const TriangleMesh mesh = tree(6, back);
    const FractureResult result = broken(
        mesh, Surface::exact, {.voxelSize = 0.04, .fill = Fill::winding, .shellThickness = 0.1});
    std::vector<std::size_t> shown(mesh.triangles.size(), 0);
    for (const Fragment& fragment : result.fragments) {
      for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
        const std::uint32_t source = fragment.mesh.source[t];
        if (source == TriangleMesh::kNoSource) continue;
        ++shown[source];
        const auto normalOf = [](const TriangleMesh& of, const glm::uvec3& c) {
          return glm::normalize(
              glm::cross(of.vertices[c.y] - of.vertices[c.x], of.vertices[c.z] - of.vertices[c.x]));
        };
        const double along = glm::dot(normalOf(fragment.mesh, fragment.mesh.triangles[t]),
                                      normalOf(mesh, mesh.triangles[source]));
        EXPECT_GT(along, -1e-6) << "a back shows a front";
      }
    }
    EXPECT_EQ(std::count(shown.begin() + 12, shown.end(), 0u), 0);
  }
}

TEST(Sheets, AFewDoubledFacesOfABodyStayLeftOut) {
  TriangleMesh body = shapes::ball(1.0, 4);
  const auto first = static_cast<std::uint32_t>(body.vertices.size());
  body.vertices.push_back(1.1 * body.vertices[0]);
  const glm::uvec3 t = body.triangles[0];
  const glm::uvec3 flap(t.x, t.y, first);
  body.triangles.insert(body.triangles.end(), {flap, {flap.z, flap.y, flap.x}});
  const Solid solid = voxelize(body, {.resolution = 64});
  EXPECT_EQ(solid.report.sheetThickness, 0.0);
  EXPECT_EQ(solid.report.defects.sheetTriangles, 2u);
}

// Faces between cells that share vertices are there from both sides, inside the solid.
TEST(Sheets, AreNotTheWallsBetweenCells) {
  TriangleMesh cells;
  const auto at = [](int i, int j, int k) { return static_cast<std::uint32_t>(9 * i + 3 * j + k); };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) cells.vertices.emplace_back(i, j, k);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      for (int k = 0; k < 2; ++k) {
        const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
          cells.triangles.insert(cells.triangles.end(), {{a, b, c}, {a, c, d}});
        };
        const auto v = [&](int x, int y, int z) { return at(i + x, j + y, k + z); };
        quad(v(0, 0, 0), v(0, 0, 1), v(0, 1, 1), v(0, 1, 0));
        quad(v(1, 0, 0), v(1, 1, 0), v(1, 1, 1), v(1, 0, 1));
        quad(v(0, 0, 0), v(1, 0, 0), v(1, 0, 1), v(0, 0, 1));
        quad(v(0, 1, 0), v(0, 1, 1), v(1, 1, 1), v(1, 1, 0));
        quad(v(0, 0, 0), v(0, 1, 0), v(1, 1, 0), v(1, 0, 0));
        quad(v(0, 0, 1), v(1, 0, 1), v(1, 1, 1), v(0, 1, 1));
      }
    }
  }
  const Solid solid = voxelize(cells, {.voxelSize = 0.05});
  EXPECT_EQ(solid.report.defects.sheetTriangles, 0u);
  EXPECT_EQ(solid.report.sheetThickness, 0.0);
  EXPECT_NEAR(volumeOf(solid), 8.0, 1e-9);
}

// Two boxes that share corners, and split the face between them by different diagonals.
TEST(Sheets, AreNotTheFacesOfBodiesThatTouch) {
  TriangleMesh boxes;
  for (int i = 0; i < 3; ++i) {
    boxes.vertices.insert(boxes.vertices.end(), {{i, 0, 0}, {i, 1, 0}, {i, 1, 1}, {i, 0, 1}});
  }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    boxes.triangles.insert(boxes.triangles.end(), {{a, b, c}, {a, c, d}});
  };
  for (std::uint32_t low = 0; low < 8; low += 4) {
    const std::uint32_t high = low + 4;
    for (std::uint32_t k = 0; k < 4; ++k) {
      quad(low + k, low + (k + 1) % 4, high + (k + 1) % 4, high + k);
    }
    quad(low + 3, low + 2, low + 1, low), quad(high, high + 1, high + 2, high + 3);
  }
  const Repaired found = repaired(boxes);
  EXPECT_EQ(found.mesh.triangles.size(), boxes.triangles.size());
  EXPECT_TRUE(found.sheets.empty());
}

// A pane shares all its edges with the frame around it, and lies in the open.
TEST(Sheets, OfAPaneInAFrameAreKept) {
  TriangleMesh frame;
  // The section's corners, at half sides of 1 and 1.3, in z of -0.1 and 0.1, and 1 in the middle.
  const double half[] = {1.0, 1.3, 1.3, 1.0, 1.0}, z[] = {-0.1, -0.1, 0.1, 0.1, 0.0};
  for (int side = 0; side < 4; ++side) {
    const double x = side == 0 || side == 3 ? -1.0 : 1.0, y = side < 2 ? -1.0 : 1.0;
    for (int k = 0; k < 5; ++k) frame.vertices.emplace_back(half[k] * x, half[k] * y, z[k]);
  }
  const auto at = [](std::uint32_t side, std::uint32_t k) { return 5 * (side % 4) + k % 5; };
  for (std::uint32_t side = 0; side < 4; ++side) {
    for (std::uint32_t k = 0; k < 5; ++k) {
      frame.triangles.emplace_back(at(side, k), at(side + 1, k), at(side + 1, k + 1));
      frame.triangles.emplace_back(at(side, k), at(side + 1, k + 1), at(side, k + 1));
    }
  }
  ASSERT_NEAR(std::abs(volume(frame)), (2.6 * 2.6 - 2.0 * 2.0) * 0.2, 1e-9);
  const std::uint32_t a = at(0, 4), b = at(1, 4), c = at(2, 4), d = at(3, 4);
  frame.triangles.insert(frame.triangles.end(), {{a, b, c}, {a, c, d}, {c, b, a}, {d, c, a}});
  const Solid solid = voxelize(frame, {.voxelSize = 0.02});
  EXPECT_EQ(solid.report.defects.sheetTriangles, 4u);
  // The centers of two layers of voxels are within 1.25 voxels of the pane.
  EXPECT_NEAR(volumeOf(solid), 2.76 * 0.2 + 4.0 * 0.04, 1e-9);
}

TEST(Sheets, AThicknessForNoneIsRefused) {
  EXPECT_THROW((void)voxelize(shapes::cube(1.0),
                              {.resolution = 32, .fill = Fill::winding, .shellThickness = 0.1}),
               Error);
}

}  // namespace
}  // namespace sherd
