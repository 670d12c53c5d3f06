// Closed meshes cut by open surfaces.
#include "intersect/cut_mesh.h"

#include <gtest/gtest.h>
#include <sherd/error.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "shapes.h"

namespace sherd {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge undirected(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

// A sheet of n * n squares over [-1, 1]^2, each of two triangles; its front is above it.
Cutters sheet(int n, const std::function<glm::dvec3(double, double)>& at) {
  Cutters cutters;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) cutters.vertices.push_back(at(2.0 * i / n - 1, 2.0 * j / n - 1));
  }
  const auto vertex = [n](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      cutters.triangles.emplace_back(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
      cutters.triangles.emplace_back(vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
    }
  }
  return cutters;
}

glm::dvec3 rotated(const glm::dvec3& p) {
  const glm::dvec3 w = glm::normalize(glm::dvec3(0.31, 0.52, 0.83));
  const glm::dvec3 u = glm::normalize(glm::cross(w, glm::dvec3(0.2, -0.9, 0.4)));
  return glm::dmat3(u, glm::cross(w, u), w) * p;
}

Cutters planeSheet(int n, double height) {
  return sheet(n, [=](double x, double y) { return rotated({3.0 * x, 3.0 * y, height}); });
}

Cutters wavySheet(int n) {
  return sheet(n, [](double x, double y) {
    return rotated({1.5 * x, 1.5 * y, 0.15 * std::sin(9.0 * x + 1.0) * std::sin(8.0 * y)});
  });
}

// Sheets that meet in the z axis, at equal angles, each of `n` pieces along the axis and one out.
Cutters fan(int sheets, double firstAngle, int n) {
  Cutters cutters;
  const auto height = [n](int i) { return 2.2 * i / n - 1.1; };
  for (int i = 0; i <= n; ++i) cutters.vertices.emplace_back(0.0, 0.0, height(i));
  for (int k = 0; k < sheets; ++k) {
    const double angle = firstAngle + 2.0 * std::numbers::pi * k / sheets;
    const auto first = static_cast<std::uint32_t>(cutters.vertices.size());
    for (int i = 0; i <= n; ++i) {
      cutters.vertices.emplace_back(3.0 * std::cos(angle), 3.0 * std::sin(angle), height(i));
    }
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(n); ++i) {
      cutters.triangles.emplace_back(i, first + i, first + i + 1);
      cutters.triangles.emplace_back(i, first + i + 1, i + 1);
    }
  }
  return cutters;
}

// A surface and cutters with their cut.
struct Cut {
  TriangleMesh surface;
  Cutters cutters;
  MeshCut cut;
  std::vector<glm::dvec3> vertices;               // as the cut numbers them
  std::vector<CutTriangle> ofSurface, ofCutters;  // parts, and whole triangles

  Cut(const TriangleMesh& s, const Cutters& c)
      : surface(s), cutters(c), cut(cutMesh(s, c)), vertices(s.vertices) {
    vertices.insert(vertices.end(), c.vertices.begin(), c.vertices.end());
    vertices.insert(vertices.end(), cut.points.begin(), cut.points.end());
    if (!cut.isComplete()) return;
    ofSurface = all(cut.surface, surface.triangles, cut.surfaceCrossed, 0);
    ofCutters = all(cut.cutters, cutters.triangles, cut.cutterCrossed,
                    static_cast<std::uint32_t>(s.vertices.size()));
  }

  [[nodiscard]] glm::dvec3 areaVector(const glm::uvec3& t) const {
    return 0.5 * glm::cross(vertices[t.y] - vertices[t.x], vertices[t.z] - vertices[t.x]);
  }

 private:
  static std::vector<CutTriangle> all(std::vector<CutTriangle> parts,
                                      const std::vector<glm::uvec3>& triangles,
                                      const std::vector<std::uint8_t>& crossed,
                                      std::uint32_t first) {
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      if (!crossed[i]) parts.push_back({triangles[i] + first, i});
    }
    return parts;
  }
};

// Connected triangles of a cut; seams and edges of more than two triangles separate them.
std::vector<std::size_t> components(const std::vector<CutTriangle>& triangles,
                                    const std::set<Edge>& seams) {
  std::map<Edge, std::vector<std::size_t>> at;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const glm::uvec3& t = triangles[i].corner;
    for (int k = 0; k < 3; ++k) at[undirected(t[k], t[(k + 1) % 3])].push_back(i);
  }
  std::vector<std::size_t> parent(triangles.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& [edge, around] : at) {
    if (around.size() != 2 || seams.contains(edge)) continue;
    const std::size_t a = root(around[0]), b = root(around[1]);
    parent[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = root(i);
  return parent;
}

std::map<Edge, std::vector<std::size_t>> directedEdges(const std::vector<CutTriangle>& triangles) {
  std::map<Edge, std::vector<std::size_t>> at;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const glm::uvec3& t = triangles[i].corner;
    for (int k = 0; k < 3; ++k) at[{t[k], t[(k + 1) % 3]}].push_back(i);
  }
  return at;
}

// The pieces that a surface is cut into, as closed meshes: components of the surface with the
// sides of the cutters' components inside it that the seams join them to.
std::vector<TriangleMesh> piecesOf(const Cut& c) {
  std::set<Edge> seamEdges;
  for (const Seam& seam : c.cut.seams) seamEdges.insert(undirected(seam.from, seam.to));
  const auto ofSurface = components(c.ofSurface, seamEdges);
  const auto ofCutters = components(c.ofCutters, seamEdges);
  const auto surfaceAt = directedEdges(c.ofSurface), cutterAt = directedEdges(c.ofCutters);
  // Nodes: components of the surface, then each component of the cutters from behind and in front.
  const std::size_t first = c.ofSurface.size();
  std::vector<std::size_t> parent(first + 2 * c.ofCutters.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::set<std::size_t> inside;
  for (const Seam& seam : c.cut.seams) {
    const Edge forward{seam.from, seam.to}, backward{seam.to, seam.from};
    static_assert(!Seam::leftInSurfaceIsFront && Seam::leftInCutterIsFront);
    const std::size_t behind = ofSurface[surfaceAt.at(forward).at(0)];
    const std::size_t front = ofSurface[surfaceAt.at(backward).at(0)];
    const std::size_t within = ofCutters[cutterAt.at(backward).at(0)];
    inside.insert(within);
    parent[root(first + 2 * within)] = root(behind);
    parent[root(first + 2 * within + 1)] = root(front);
  }
  std::map<std::size_t, TriangleMesh> pieces;
  for (std::size_t i = 0; i < c.ofSurface.size(); ++i) {
    pieces[root(ofSurface[i])].triangles.push_back(c.ofSurface[i].corner);
  }
  for (std::size_t i = 0; i < c.ofCutters.size(); ++i) {
    if (!inside.contains(ofCutters[i])) continue;
    const glm::uvec3& t = c.ofCutters[i].corner;
    pieces[root(first + 2 * ofCutters[i])].triangles.push_back(t);
    pieces[root(first + 2 * ofCutters[i] + 1)].triangles.emplace_back(t.z, t.y, t.x);
  }
  std::vector<TriangleMesh> meshes;
  for (auto& [node, mesh] : pieces) {
    mesh.vertices = c.vertices;
    meshes.push_back(std::move(mesh));
  }
  return meshes;
}

// Checks what is true of any complete cut.
void expectCut(const Cut& c) {
  ASSERT_TRUE(c.cut.isComplete());
  ASSERT_FALSE(c.cut.seams.empty());
  // Parts cover their triangles.
  const auto expectCovered = [&](const std::vector<CutTriangle>& parts,
                                 const std::vector<glm::uvec3>& triangles, std::uint32_t first) {
    std::vector<glm::dvec3> sum(triangles.size(), glm::dvec3(0.0));
    for (const CutTriangle& part : parts) sum[part.source] += c.areaVector(part.corner);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const glm::dvec3 whole = c.areaVector(triangles[i] + first);
      EXPECT_LE(glm::length(sum[i] - whole), 1e-14 + 1e-12 * glm::length(whole));
    }
  };
  expectCovered(c.ofSurface, c.surface.triangles, 0);
  expectCovered(c.ofCutters, c.cutters.triangles,
                static_cast<std::uint32_t>(c.surface.vertices.size()));
  // The surface is still closed.
  const auto surfaceAt = directedEdges(c.ofSurface), cutterAt = directedEdges(c.ofCutters);
  for (const auto& [edge, triangles] : surfaceAt) {
    EXPECT_EQ(triangles.size(), 1u);
    EXPECT_TRUE(surfaceAt.contains({edge.second, edge.first}));
  }
  // Seams are edges of both on both sides, in parts of their triangles.
  for (const Seam& seam : c.cut.seams) {
    for (const Edge& edge : {Edge{seam.from, seam.to}, Edge{seam.to, seam.from}}) {
      ASSERT_TRUE(surfaceAt.contains(edge));
      ASSERT_TRUE(cutterAt.contains(edge));
      const auto& parts = cutterAt.at(edge);
      EXPECT_EQ(c.ofSurface[surfaceAt.at(edge)[0]].source, seam.s);
      EXPECT_TRUE(std::any_of(parts.begin(), parts.end(),
                              [&](std::size_t i) { return c.ofCutters[i].source == seam.c; }));
    }
  }
}

double sumOfVolumes(const std::vector<TriangleMesh>& pieces) {
  double sum = 0.0;
  for (const TriangleMesh& piece : pieces) {
    EXPECT_EQ(openEdges(piece), 0u);
    EXPECT_GT(volume(piece), 0.0);
    sum += volume(piece);
  }
  return sum;
}

TEST(CutMesh, APlaneThroughTheCenterHalvesACube) {
  for (const int n : {1, 7, 40}) {
    const Cut c(shapes::cube(1.0), planeSheet(n, 0.0));
    expectCut(c);
    const auto pieces = piecesOf(c);
    ASSERT_EQ(pieces.size(), 2u);
    EXPECT_NEAR(sumOfVolumes(pieces), 1.0, 1e-12);
    EXPECT_NEAR(volume(pieces[0]), 0.5, 1e-12);
  }
}

TEST(CutMesh, APlaneThroughTheCenterHalvesABall) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const Cut c(ball, planeSheet(11, 0.0));
  expectCut(c);
  const auto pieces = piecesOf(c);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_NEAR(sumOfVolumes(pieces), volume(ball), 1e-12);
  EXPECT_NEAR(volume(pieces[0]), 0.5 * volume(ball), 1e-12);
}

// The area of the square [-1/2, 1/2]^2 between two directions from a point inside.
double squareSector(const glm::dvec2& from, double firstAngle, double lastAngle) {
  const auto hit = [&](double angle) {
    const glm::dvec2 along(std::cos(angle), std::sin(angle));
    const glm::dvec2 steps = (0.5 * glm::sign(along) - from) / along;
    return std::min(steps.x, steps.y) * along;
  };
  std::vector<glm::dvec2> polygon{hit(firstAngle)};
  for (int turn = 0; turn < 8; ++turn) {
    const double quarter = std::numbers::pi / 4.0 * (2 * (turn % 4) + 1);
    const glm::dvec2 corner =
        0.5 * glm::sign(glm::dvec2(std::cos(quarter), std::sin(quarter))) - from;
    double angle = std::atan2(corner.y, corner.x);
    if (angle < 0.0) angle += 2.0 * std::numbers::pi;
    if (turn >= 4) angle += 2.0 * std::numbers::pi;
    if (angle > firstAngle && angle < lastAngle) polygon.push_back(corner);
  }
  polygon.push_back(hit(lastAngle));
  double twice = 0.0;
  for (std::size_t i = 0; i + 1 < polygon.size(); ++i) {
    twice += polygon[i].x * polygon[i + 1].y - polygon[i].y * polygon[i + 1].x;
  }
  return 0.5 * twice;
}

TEST(CutMesh, SheetsThatShareAnEdgeCutSectors) {
  for (const int sheets : {3, 4}) {
    const double angle = 0.2, step = 2.0 * std::numbers::pi / sheets;
    const glm::dvec2 axis(0.13, -0.06);
    const Cut c(shapes::cube(1.0, glm::dvec3(-axis, 0.0)), fan(sheets, angle, 5));
    expectCut(c);
    const auto pieces = piecesOf(c);
    ASSERT_EQ(pieces.size(), static_cast<std::size_t>(sheets));
    std::vector<double> volumes, expected;
    for (const TriangleMesh& piece : pieces) volumes.push_back(volume(piece));
    for (int k = 0; k < sheets; ++k) {
      expected.push_back(squareSector(axis, angle + k * step, angle + (k + 1) * step));
    }
    std::sort(volumes.begin(), volumes.end());
    std::sort(expected.begin(), expected.end());
    for (std::size_t k = 0; k < volumes.size(); ++k) EXPECT_NEAR(volumes[k], expected[k], 1e-12);
  }
}

TEST(CutMesh, AWavySheetCutsPiecesThatFillTheSolid) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  for (const TriangleMesh& solid : {shapes::cube(1.3), ball}) {
    const Cut c(solid, wavySheet(60));
    expectCut(c);
    const auto pieces = piecesOf(c);
    EXPECT_EQ(pieces.size(), 2u);
    EXPECT_NEAR(sumOfVolumes(pieces), volume(solid), 1e-12);
  }
}

TEST(CutMesh, ACutterThroughAFaceMakesALoopInIt) {
  // A cone of cutters whose tip is outside of the cube and whose rim is inside.
  Cutters cone;
  cone.vertices.emplace_back(0.03, 0.12, 0.8);
  constexpr std::uint32_t kSides = 30;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 0.1 + 2.0 * std::numbers::pi * i / kSides;
    cone.vertices.emplace_back(0.03 + 0.3 * std::cos(angle), 0.12 + 0.3 * std::sin(angle), 0.11);
    cone.triangles.emplace_back(0, 1 + i, 1 + (i + 1) % kSides);
  }
  const Cut c(shapes::cube(1.0), cone);
  expectCut(c);
  EXPECT_GE(c.cut.seams.size(), kSides);
}

TEST(CutMesh, CuttersApartLeaveTheMeshWhole) {
  const MeshCut cut = cutMesh(shapes::cube(1.0), planeSheet(5, 2.0));
  EXPECT_TRUE(cut.isComplete());
  EXPECT_TRUE(cut.seams.empty());
  EXPECT_TRUE(cut.surface.empty());
  EXPECT_EQ(cut.surfaceCrossed, std::vector<std::uint8_t>(12, 0));
  EXPECT_EQ(cut.cutterCrossed, std::vector<std::uint8_t>(50, 0));
  EXPECT_TRUE(cutMesh(shapes::cube(1.0), {}).seams.empty());
}

TEST(CutMesh, AVertexOnTheSurfaceIsReported) {
  const Cutters touching{{{0.1, 0.2, 0.5}, {0.2, 0.1, 0.9}, {0.3, 0.25, 0.8}}, {{0, 1, 2}}};
  EXPECT_EQ(cutMesh(shapes::cube(1.0), touching).degenerate, std::vector<std::uint32_t>{0});
  // In a face's plane beside the face, it does not matter.
  const Cutters beside{{{0.1, 0.7, 0.5}, {0.2, 0.1, 0.9}, {0.3, 0.25, 0.8}}, {{0, 1, 2}}};
  EXPECT_TRUE(cutMesh(shapes::cube(1.0), beside).isComplete());
}

TEST(CutMesh, AnEdgeThroughAnEdgeIsReported) {
  const Cutters cutters{{{0.4, 0.4, 0.1}, {0.6, 0.6, 0.1}, {0.7, 0.1, 0.3}}, {{0, 1, 2}}};
  const MeshCut cut = cutMesh(shapes::cube(1.0), cutters);
  EXPECT_EQ(cut.degenerate, (std::vector<std::uint32_t>{0, 1}));
}

TEST(CutMesh, APlaneThroughASurfacesVertexIsReported) {
  const Cutters cutters{{{1.0, -1.0, 0.0}, {1.0, 3.0, 0.0}, {-2.0, 1.0, 3.0}}, {{0, 1, 2}}};
  // The plane x + z = 1 contains an edge of the cube.
  EXPECT_EQ(cutMesh(shapes::cube(1.0), cutters).degenerate, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(CutMesh, CutterTrianglesWithoutAreaAreReported) {
  const Cutters cutters{{{0.1, 0.2, 0.2}, {0.1, 0.2, 0.4}, {0.1, 0.2, 0.9}}, {{0, 1, 2}}};
  EXPECT_EQ(cutMesh(shapes::cube(1.0), cutters).degenerate, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(CutMesh, SurfaceTrianglesWithoutAreaAreReported) {
  TriangleMesh flat;
  flat.vertices = {{0, 0, -1}, {0, 0, 0.25}, {0, 0, 1}};
  flat.triangles = {{0, 1, 2}};
  const Cutters cutters{{{-1, -1, 0.1}, {1, -1, 0.1}, {0, 1.5, 0.1}}, {{0, 1, 2}}};
  EXPECT_EQ(cutMesh(flat, cutters).flat, std::vector<std::uint32_t>{0});
}

TEST(CutMesh, CuttersThatCrossOnTheSurfaceAreReported) {
  const Cutters cutters{{{0.1, 0.23, 0.2},
                         {0.3, 0.21, 0.2},
                         {0.2, 0.22, 0.9},
                         {0.21, 0.1, 0.2},
                         {0.19, 0.3, 0.2},
                         {0.2, 0.2, 0.9}},
                        {{0, 1, 2}, {3, 4, 5}}};
  const MeshCut cut = cutMesh(shapes::cube(1.0), cutters);
  ASSERT_EQ(cut.cutterCrossings.size(), 1u);
  EXPECT_EQ(cut.cutterCrossings[0], (std::array<std::uint32_t, 2>{0, 1}));
  EXPECT_TRUE(cut.surfaceCrossings.empty());
}

TEST(CutMesh, SurfacesThatCrossOnACutterAreReported) {
  const TriangleMesh two =
      shapes::append(shapes::cube(1.0), shapes::cube(1.0, glm::dvec3(0.31, 0.47, 0.12)));
  const MeshCut cut = cutMesh(two, planeSheet(1, 0.1));
  EXPECT_FALSE(cut.surfaceCrossings.empty());
  for (const auto& [a, b] : cut.surfaceCrossings) EXPECT_TRUE(a < 12 && b >= 12);
  EXPECT_TRUE(cut.cutterCrossings.empty());
}

std::vector<std::uint32_t> words(const MeshCut& cut, const std::vector<CutTriangle>& parts) {
  std::vector<std::uint32_t> all;
  for (const CutTriangle& part : parts) {
    all.insert(all.end(), {part.corner.x, part.corner.y, part.corner.z, part.source});
  }
  for (const Seam& seam : cut.seams) {
    all.insert(all.end(), {seam.from, seam.to, seam.s, seam.c});
  }
  return all;
}

TEST(CutMesh, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh ball = shapes::ball(1.0, 5);
  const Cutters cutters = wavySheet(40);
  std::array<MeshCut, 2> cuts;
  for (int threads = 1; threads <= 2; ++threads) {
    tbb::task_arena arena(threads);
    arena.execute([&] { cuts[static_cast<std::size_t>(threads - 1)] = cutMesh(ball, cutters); });
  }
  EXPECT_EQ(cuts[0].points, cuts[1].points);
  EXPECT_EQ(words(cuts[0], cuts[0].surface), words(cuts[1], cuts[1].surface));
  EXPECT_EQ(words(cuts[0], cuts[0].cutters), words(cuts[1], cuts[1].cutters));
}

TEST(CutMesh, StopsOnRequest) {
  const Progress stop{{}, [] { return true; }};
  try {
    (void)cutMesh(shapes::cube(1.0), planeSheet(3, 0.0), &stop);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace sherd
