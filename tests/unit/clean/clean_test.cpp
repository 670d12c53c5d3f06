// Pieces of exact surfaces have no short edges and no thin triangles.
#include "clean/clean.h"

#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/union_find.h"
#include "cli/evaluate/cgal_checks.h"
#include "exact_checks.h"
#include "intersect/crossing_point.h"
#include "mesh_checks.h"
#include "shapes.h"

namespace sherd {
namespace {

// Merging by distance with this share of the box is the first that artists do.
constexpr double kMergeShare = 1e-5;

struct Breaking {
  int pieces = 8, resolution = 48;
  std::uint64_t seed = 3;
};

std::vector<Fragment> pieces(const TriangleMesh& mesh, double roughness,
                             const Breaking& breaking = {}) {
  FractureOptions options;
  options.pieces = breaking.pieces;
  options.seed = breaking.seed;
  options.solid.resolution = breaking.resolution;
  options.grow.roughness = roughness;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  Device device("builtin");
  FractureResult result = fracture(mesh, options, device);
  EXPECT_EQ(result.exactFailure, "");
  return std::move(result.fragments);
}

TriangleMesh rounded(TriangleMesh mesh) {
  for (glm::dvec3& v : mesh.vertices) v = glm::dvec3(glm::vec3(v));
  return mesh;
}

// To where floats are 2^-14 apart, a five-hundredth of a voxel.
TriangleMesh moved(const TriangleMesh& mesh) {
  return shapes::transformed(mesh, 1.0, {1000, 700, -900});
}

double heightOf(const TriangleMesh& mesh, const glm::uvec3& t) {
  const std::vector<glm::dvec3>& v = mesh.vertices;
  const double longest = std::max({glm::distance(v[t.x], v[t.y]), glm::distance(v[t.y], v[t.z]),
                                   glm::distance(v[t.z], v[t.x])});
  return glm::length(glm::cross(v[t.y] - v[t.x], v[t.z] - v[t.x])) / longest;
}

std::size_t flatTriangles(const TriangleMesh& mesh) {
  return static_cast<std::size_t>(
      std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const glm::uvec3& t) {
        return areCollinear({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]});
      }));
}

// Vertices nearer to each other than a distance become one, as Blender merges them.
TriangleMesh mergedByDistance(const TriangleMesh& mesh, double distance) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  for (std::uint32_t v = 0; v < order.size(); ++v) order[v] = v;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return mesh.vertices[a].x < mesh.vertices[b].x;
  });
  UnionFind same(mesh.vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t k = i; k-- > 0;) {
      const glm::dvec3 &p = mesh.vertices[order[i]], &q = mesh.vertices[order[k]];
      if (p.x - q.x > distance) break;
      if (glm::distance(p, q) <= distance) same.unite(order[i], order[k]);
    }
  }
  TriangleMesh out{mesh.vertices, {}};
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::uvec3 c(same.find(t.x), same.find(t.y), same.find(t.z));
    if (c.x != c.y && c.y != c.z && c.z != c.x) out.triangles.push_back(c);
  }
  return out;
}

class CleanPieces : public testing::TestWithParam<std::tuple<const char*, TriangleMesh, double>> {
 protected:
  [[nodiscard]] static const TriangleMesh& input() { return std::get<1>(GetParam()); }
  [[nodiscard]] static std::vector<Fragment> broken() {
    return pieces(input(), std::get<2>(GetParam()));
  }
};

TEST_P(CleanPieces, HaveNoShortEdgeAndNoThinTriangle) {
  const double least = kMergeShare * longestSide(bounds(input()));
  const std::vector<Fragment> fragments = broken();
  for (const Fragment& fragment : fragments) {
    std::size_t edges = 0, thin = 0;
    for (const glm::uvec3& t : fragment.mesh.triangles) {
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 &p = fragment.mesh.vertices[t[k]],
                         &q = fragment.mesh.vertices[t[(k + 1) % 3]];
        edges += glm::distance(p, q) < least ? 1u : 0u;
      }
      thin += heightOf(fragment.mesh, t) < 1e-3 * least ? 1u : 0u;
    }
    EXPECT_EQ(edges, 0u) << "fragment " << fragment.id;
    EXPECT_EQ(thin, 0u) << "fragment " << fragment.id;
    EXPECT_EQ(nonManifoldEdges(mergedByDistance(fragment.mesh, least)), 0u);
  }
  const ExactFaults faults = exactFaults(input(), fragments);
  EXPECT_FALSE(faults.any()) << faults.text();
}

TEST_P(CleanPieces, StaySoundInSinglePrecision) {
  if (!hasCgalChecks()) GTEST_SKIP() << "this build has no checks by CGAL (SHERD_GPL)";
  for (const Fragment& fragment : broken()) {
    const TriangleMesh mesh = rounded(fragment.mesh);
    EXPECT_EQ(flatTriangles(mesh), 0u);
    EXPECT_EQ(checkWithCgal(mesh, 1, 0).selfIntersections, 0u) << "fragment " << fragment.id;
  }
}

// Without the changes for single precision 3 pairs of triangles cross.
TEST(Clean, PiecesFarFromTheOriginAreSoundInSinglePrecision) {
  if (!hasCgalChecks()) GTEST_SKIP() << "this build has no checks by CGAL (SHERD_GPL)";
  for (const Fragment& fragment : pieces(moved(shapes::cube(2.0)), 0.0, {12, 128, 0})) {
    const TriangleMesh single = rounded(fragment.mesh);
    EXPECT_EQ(flatTriangles(single), 0u);
    EXPECT_EQ(checkWithCgal(single, 1, 0).selfIntersections, 0u) << "fragment " << fragment.id;
  }
}

// With this seed cracks come together so that a piece touches itself along an edge.
TEST(Clean, NoPieceTouchesItself) {
  const TriangleMesh cube = shapes::cube(2.0);
  const std::vector<Fragment> fragments = pieces(cube, 3.0, {8, 48, 0});
  for (const Fragment& fragment : fragments) {
    EXPECT_EQ(coincidentVertices(fragment.mesh), 0u) << "fragment " << fragment.id;
    EXPECT_EQ(nonManifoldEdges(mergedByDistance(fragment.mesh, 2.0 * kMergeShare)), 0u);
    expectClosedManifold(fragment.mesh);
  }
  const ExactFaults faults = exactFaults(cube, fragments);
  EXPECT_FALSE(faults.any()) << faults.text();
}

// The outside is cut, not moved: its points are in the planes of the input's triangles.
TEST_P(CleanPieces, HaveTheInputsPlanes) {
  const double side = longestSide(bounds(input()));
  for (const Fragment& fragment : broken()) {
    double farthest = 0.0;
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      if (fragment.mesh.source[t] == TriangleMesh::kNoSource) continue;
      const glm::uvec3& own = input().triangles[fragment.mesh.source[t]];
      const std::vector<glm::dvec3>& at = input().vertices;
      const glm::dvec3 normal =
          glm::normalize(glm::cross(at[own.y] - at[own.x], at[own.z] - at[own.x]));
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3& p = fragment.mesh.vertices[fragment.mesh.triangles[t][k]];
        farthest = std::max(farthest, std::abs(glm::dot(p - at[own.x], normal)));
      }
    }
    EXPECT_LT(farthest, 1e-15 * side * (1.0 + glm::length(input().vertices.front())));
  }
}

INSTANTIATE_TEST_SUITE_P(Clean, CleanPieces,
                         testing::Values(std::tuple("cube", shapes::cube(2.0), 0.0),
                                         std::tuple("roughCube", shapes::cube(2.0), 3.0),
                                         std::tuple("ball", shapes::ball(1.0, 3), 0.0),
                                         std::tuple("roughBall", shapes::ball(1.0, 3), 2.0),
                                         std::tuple("torus", shapes::torus(1.0, 0.3, 48, 24), 2.0),
                                         std::tuple("farCube", moved(shapes::cube(2.0)), 0.0),
                                         std::tuple("farBall", moved(shapes::ball(1.0, 3)), 1.0),
                                         std::tuple("cup", shapes::cup(1.0, 0.05, 1.5, 0.1, 40),
                                                    0.0)),
                         [](const auto& shape) { return std::string(std::get<0>(shape.param)); });

CleanMesh meshOf(const TriangleMesh& piece, std::size_t fixed) {
  CleanMesh mesh{piece.vertices, std::vector<bool>(piece.vertices.size(), false), {}};
  std::fill_n(mesh.isFixed.begin(), fixed, true);
  for (const glm::uvec3& t : piece.triangles) mesh.faces.push_back({t, 1, 2});
  return mesh;
}

TriangleMesh tetrahedron(double edge) {
  return {{{0, 0, 0}, {edge, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

TEST(Clean, DoesNotFoldATetrahedronToASheet) {
  const Cleaned result = cleaned(meshOf(tetrahedron(1e-6), 0), {}, {.tolerance = 1e-3});
  EXPECT_EQ(result.changes, 0u);
  EXPECT_EQ(result.mesh.faces.size(), 4u);
}

// A ball with a vertex that is split in two along an edge.
TriangleMesh withShortEdge(double length) {
  TriangleMesh mesh = shapes::ball(1.0, 2);
  const glm::uvec3 t = mesh.triangles.front();
  const glm::dvec3 from = mesh.vertices[t.x], to = mesh.vertices[t.y];
  const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(from + length * glm::normalize(to - from));
  std::vector<glm::uvec3> triangles;
  for (const glm::uvec3& own : mesh.triangles) {
    glm::uvec3 first = own, second = own;
    bool hasX = false, hasY = false;
    for (int k = 0; k < 3; ++k) {
      if (own[k] == t.x) second[k] = middle, hasX = true;
      if (own[k] == t.y) first[k] = middle, hasY = true;
    }
    if (hasX && hasY) {
      triangles.push_back(first);
      triangles.push_back(second);
    } else {
      triangles.push_back(own);
    }
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

TEST(Clean, CollapsesAShortEdgeAndKeepsFixedVertices) {
  const TriangleMesh split = withShortEdge(1e-5);
  const std::size_t fixed = split.vertices.size() - 1;
  const Cleaned result = cleaned(meshOf(split, fixed), {}, {.tolerance = 1e-4});
  EXPECT_EQ(result.changes, 1u);
  EXPECT_EQ(result.mesh.vertices, split.vertices);
  const TriangleMesh ball = shapes::ball(1.0, 2);
  EXPECT_EQ(result.mesh.faces.size(), ball.triangles.size());
  TriangleMesh after{result.mesh.vertices, {}};
  for (const CleanFace& face : result.mesh.faces) after.triangles.push_back(face.corner);
  EXPECT_EQ(nonManifoldEdges(after), 0u);
  EXPECT_NEAR(volume(after), volume(ball), 1e-15);
}

TEST(Clean, LeavesEdgesBetweenFixedVertices) {
  const TriangleMesh split = withShortEdge(1e-5);
  EXPECT_EQ(cleaned(meshOf(split, split.vertices.size()), {}, {.tolerance = 1e-4}).changes, 0u);
}

TEST(Clean, LeavesWhatIsLongerThanTheTolerance) {
  EXPECT_EQ(cleaned(meshOf(withShortEdge(1e-3), 0), {}, {.tolerance = 1e-4}).changes, 0u);
}

}  // namespace
}  // namespace sherd
