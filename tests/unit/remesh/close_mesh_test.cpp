// Surface::exact of meshes with holes.
#include "remesh/parts/close_mesh.h"

#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "appearance/source_faces.h"
#include "appearance/transfer.h"
#include "exact_checks.h"
#include "intersect/self_crossings.h"
#include "mesh/positions.h"
#include "shapes.h"

namespace sherd {
namespace {

constexpr auto kNoSource = TriangleMesh::kNoSource;

FractureOptions exactOptions(int pieces, int resolution, double roughness = 0.0) {
  FractureOptions options;
  options.pieces = pieces;
  options.seed = 7;
  options.solid = {.resolution = resolution, .fill = Fill::winding};
  options.grow.roughness = roughness;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  return options;
}

FractureResult broken(const TriangleMesh& mesh, const FractureOptions& options) {
  Device device("builtin");
  return fracture(mesh, options, device);
}

// A shape with holes, and what is known of it.
struct Open {
  std::string name;
  TriangleMesh mesh;
  std::size_t holes = 0;
  double volume = 0.0;  // with the holes closed; 0: that of the closed mesh
};

// Returns a mesh without some of its triangles.
template <class Leaves>
TriangleMesh without(TriangleMesh mesh, const Leaves& leaves) {
  std::vector<glm::uvec3> kept;
  for (const glm::uvec3& t : mesh.triangles) {
    if (!leaves(mesh, t)) kept.push_back(t);
  }
  mesh.triangles = std::move(kept);
  return mesh;
}

// Whether all corners are at a height.
auto isAt(double z) {
  return [z](const TriangleMesh& mesh, const glm::uvec3& t) {
    return mesh.vertices[t.x].z == z && mesh.vertices[t.y].z == z && mesh.vertices[t.z].z == z;
  };
}

TriangleMesh openBox(double side, const glm::dvec3& offset = glm::dvec3(0.0)) {
  TriangleMesh box = without(shapes::cube(side), isAt(side / 2.0));
  for (glm::dvec3& v : box.vertices) v += offset;
  return box;
}

TriangleMesh tube(int segments, double radius, double height) {
  TriangleMesh mesh;
  for (int i = 0; i < segments; ++i) {
    const double a = 2.0 * std::numbers::pi * i / segments;
    for (const double z : {0.0, height})
      mesh.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), z);
  }
  for (int i = 0; i < segments; ++i) {
    const auto a = static_cast<std::uint32_t>(2 * i);
    const auto b = static_cast<std::uint32_t>(2 * ((i + 1) % segments));
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, b + 1}, {a, b + 1, a + 1}});
  }
  return mesh;
}

// A grid of n x n quads of the plane with heights, seen from above.
template <class Height>
TriangleMesh terrain(int n, const Height& height) {
  TriangleMesh mesh;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = 2.0 * i / n - 1.0, y = 2.0 * j / n - 1.0;
      mesh.vertices.emplace_back(x, y, height(x, y));
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      // No triangle has all corners on the rim.
      const int turn = (2 * i < n) != (2 * j < n) ? 1 : 0;
      const std::array<std::uint32_t, 4> quad{at(i, j), at(i + 1, j), at(i + 1, j + 1),
                                              at(i, j + 1)};
      const auto corner = [&](int k) { return quad[static_cast<std::size_t>((k + turn) % 4)]; };
      mesh.triangles.emplace_back(corner(0), corner(1), corner(2));
      mesh.triangles.emplace_back(corner(0), corner(2), corner(3));
    }
  }
  return mesh;
}

// The volume between a surface and the origin: of a mesh whose holes are in planes through the
// origin that with the holes closed.
double volumeFromOrigin(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    sum += glm::dot(mesh.vertices[t.x], glm::cross(mesh.vertices[t.y], mesh.vertices[t.z])) / 6.0;
  }
  return sum;
}

TriangleMesh halfTorus() {
  return without(shapes::torus(2.0, 0.7, 48, 24), [](const TriangleMesh& mesh, const auto& t) {
    return (mesh.vertices[t.x] + mesh.vertices[t.y] + mesh.vertices[t.z]).y < 0.0;
  });
}

std::vector<Open> shapesWithHoles() {
  std::vector<Open> all;
  all.push_back({"openBox", openBox(2.0), 1, 8.0});
  // The surface where the winding number is 0.5 is as far as two voxels inwards of the rims.
  all.push_back({"tube", tube(32, 1.0, 2.0), 2, 16.0 * std::sin(std::numbers::pi / 16.0) * 2.0});
  const TriangleMesh ball = shapes::ball(1.0, 3);
  Open apart{"ballWithoutThreeTriangles", ball, 3, volume(ball)};
  for (const std::ptrdiff_t t : {1100, 600, 5}) {
    apart.mesh.triangles.erase(apart.mesh.triangles.begin() + t);
  }
  all.push_back(std::move(apart));
  Open together{"ballWithABentHole",
                without(ball,
                        [](const TriangleMesh& mesh, const auto& t) {
                          return (mesh.vertices[t.x] + mesh.vertices[t.y] + mesh.vertices[t.z]).z >
                                 2.6;
                        }),
                1, 0.0};
  all.push_back(std::move(together));
  const TriangleMesh hill =
      terrain(20, [](double x, double y) { return 1.5 * (1.0 - x * x) * (1.0 - y * y); });
  all.push_back({"terrain", hill, 1, volumeFromOrigin(hill)});
  const TriangleMesh arch = halfTorus();
  all.push_back({"halfTorus", arch, 2, volumeFromOrigin(arch)});
  all.push_back(
      {"twoOpenBoxes", shapes::append(openBox(1.0), openBox(1.0, {1.5, 0.0, 0.0})), 2, 2.0});
  // The rim is a ring between two loops.
  all.push_back({"thickBox",
                 shapes::append(openBox(2.0), shapes::inverted(openBox(1.0, {0, 0, 0.5}))), 2,
                 8.0 - 1.0});
  return all;
}

// Pairs of triangles that cross.  Sheets may touch: vertices at one position count as one.
std::size_t crossings(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> first = firstAtPosition(mesh.vertices);
  std::vector<glm::uvec3> triangles;
  for (const glm::uvec3& t : mesh.triangles)
    triangles.emplace_back(first[t.x], first[t.y], first[t.z]);
  return selfCrossings(mesh.vertices, triangles).size();
}

class ClosedShapes : public ::testing::TestWithParam<Open> {};

TEST_P(ClosedShapes, FragmentsKeepTheInputsTriangles) {
  const Open& open = GetParam();
  for (const double roughness : {0.0, 1.5}) {
    SCOPED_TRACE("roughness " + std::to_string(roughness));
    const FractureResult result = broken(open.mesh, exactOptions(12, 40, roughness));
    ASSERT_EQ(result.exactFailure, "");
    EXPECT_EQ(result.united.closed.holes, open.holes);
    const TriangleMesh& closed = result.united.mesh->mesh;
    EXPECT_EQ(openEdges(closed), 0u);
    ExactFaults faults = exactFaults(open.mesh, result.fragments);
    double sum = 0.0, closing = 0.0;
    for (const Fragment& fragment : result.fragments) {
      const TriangleMesh& mesh = fragment.mesh;
      sum += volume(mesh);
      EXPECT_EQ(crossings(mesh), 0u);
      TriangleMesh own{mesh.vertices, {}};
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (mesh.neighbor[t] == 0 && mesh.source[t] == kNoSource)
          own.triangles.push_back(mesh.triangles[t]);
      }
      closing += area(own);
    }
    EXPECT_NEAR(closing, result.united.closed.area, 1e-9 * closing);
    EXPECT_NEAR(closing, area(closed) - area(open.mesh), 1e-9 * area(closed));
    faults.volume = sum / volume(closed) - 1.0;
    EXPECT_FALSE(faults.any()) << faults.text();
    const double expected = open.volume != 0.0 ? open.volume : volume(closed);
    EXPECT_NEAR(sum, expected, 1e-9 * expected);
  }
}

INSTANTIATE_TEST_SUITE_P(CloseMesh, ClosedShapes, ::testing::ValuesIn(shapesWithHoles()),
                         [](const auto& open) { return open.param.name; });

// The union of the closed boxes is the outer one.
TEST(CloseMesh, AnOpenBoxWithinAnotherVanishes) {
  for (const double top : {0.0, 0.25, 0.5}) {  // below the outer rim, and level with it
    const TriangleMesh mesh = shapes::append(openBox(2.0), openBox(1.0, {0, 0, top}));
    const FractureResult result = broken(mesh, exactOptions(5, 40));
    ASSERT_EQ(result.exactFailure, "");
    double sum = 0.0;
    for (const Fragment& fragment : result.fragments) {
      EXPECT_EQ(openEdges(fragment.mesh), 0u);
      EXPECT_EQ(nonManifoldEdges(fragment.mesh), 0u);
      EXPECT_EQ(meshComponents(fragment.mesh).count, 1u);
      sum += volume(fragment.mesh);
    }
    EXPECT_NEAR(sum, 8.0, 1e-9);
  }
}

TEST(CloseMesh, OpenBoxesThatTouchBecomeOneBody) {
  const TriangleMesh mesh = shapes::append(openBox(1.0), openBox(1.0, {1.0, 0.0, 0.0}));
  const FractureResult result = broken(mesh, exactOptions(5, 40));
  ASSERT_EQ(result.exactFailure, "");
  EXPECT_EQ(result.united.before, 2u);
  EXPECT_EQ(result.united.after, 1u);
  double sum = 0.0;
  for (const Fragment& fragment : result.fragments) sum += volume(fragment.mesh);
  EXPECT_NEAR(sum, 2.0, 1e-9);
}

// Three squares at one edge.
TEST(CloseMesh, AShellThatCrossesItselfFallsBackWithTheReason) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 0, 1}};
  for (std::uint32_t k = 0; k < 3; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 3.0;
    for (const double z : {0.0, 1.0})
      mesh.vertices.emplace_back(std::cos(angle), std::sin(angle), z);
    const std::uint32_t low = 2 + 2 * k, high = low + 1;
    mesh.triangles.insert(mesh.triangles.end(), {{0, low, high}, {0, high, 1}});
  }
  FractureOptions options = exactOptions(3, 32);
  options.solid.fill = Fill::automatic;
  const FractureResult result = broken(mesh, options);
  EXPECT_EQ(result.solid.report.fill, Fill::shell);
  EXPECT_EQ(result.exactFailure, "as a shell of its thickness it crosses itself");
}

// Of a ball, two caps and a strip between them are left.  One loop goes around all, and the faces
// that fill it enclose another solid than the winding numbers.
TEST(CloseMesh, AHoleThatIsClosedOtherwiseFallsBackWithTheReason) {
  const TriangleMesh mesh =
      without(shapes::ball(1.0, 3), [](const TriangleMesh& m, const glm::uvec3& t) {
        const glm::dvec3 c = (m.vertices[t.x] + m.vertices[t.y] + m.vertices[t.z]) / 3.0;
        return std::abs(c.z) < 0.75 && !(c.x > 0.85);
      });
  const FractureResult result = broken(mesh, exactOptions(3, 40));
  EXPECT_NE(result.exactFailure.find("faces that close its holes would change"), std::string::npos)
      << result.exactFailure;
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(fragment.meshedAs, Surface::smooth);
  }
}

TEST(CloseMesh, ClosingFacesHaveTheMaterialOfTheInside) {
  TriangleMesh mesh = openBox(2.0);
  mesh.attributes.material.assign(mesh.triangles.size(), 0);
  mesh.attributes.texcoords.assign(mesh.triangles.size(), {});
  const FractureResult result = broken(mesh, exactOptions(4, 32));
  ASSERT_EQ(result.exactFailure, "");
  SourceMesh source;
  source.mesh = mesh;
  const AttributeSource attributes(mesh, true);
  std::size_t closing = 0;
  for (const Fragment& fragment : result.fragments) {
    const SurfaceAttributes own = attributes.transferTo(fragment.mesh, 7);
    const std::vector<std::int32_t> faces =
        sourceFaces(fragment.mesh, source, attributes, result.solid);
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      const bool isInput = fragment.mesh.source[t] != kNoSource;
      EXPECT_EQ(own.material[t], isInput ? 0u : 7u);
      EXPECT_EQ(faces[t] != kNoSourceFace, isInput);
      closing += !isInput && fragment.mesh.neighbor[t] == 0 ? 1u : 0u;
      EXPECT_TRUE(!isInput || fragment.mesh.neighbor[t] == 0);
    }
  }
  EXPECT_GE(closing, 2u);
}

// Two triangles that stand on an edge of the box: with their hole closed they are a sliver of a
// body.
TEST(CloseMesh, AFinOnAnEdgeIsLeftOut) {
  TriangleMesh mesh = shapes::cube(2.0);
  const glm::uvec3 base = mesh.triangles.front();
  const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(1.5 * mesh.vertices[base.x]);
  mesh.vertices.push_back(1.5 * mesh.vertices[base.y] + glm::dvec3(0.01, 0.02, 0.03));
  mesh.triangles.insert(mesh.triangles.end(), {{base.x, base.y, next}, {base.y, next + 1, next}});
  const FractureResult result = broken(mesh, exactOptions(3, 40));
  ASSERT_EQ(result.exactFailure, "");
  EXPECT_EQ(result.united.closed.holes, 1u);
  EXPECT_EQ(result.united.closed.faces, 0u);
  double sum = 0.0;
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(meshComponents(fragment.mesh).count, 1u);
    sum += volume(fragment.mesh);
  }
  EXPECT_NEAR(sum, 8.0, 1e-9);
}

TEST(CloseMesh, ErosionLeavesClosingFacesOutside) {
  FractureOptions options = exactOptions(4, 40);
  options.erode.iterations = 2;
  const FractureResult result = broken(openBox(2.0), options);
  ASSERT_EQ(result.exactFailure, "");
  double top = 0.0;
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(openEdges(fragment.mesh), 0u);
    TriangleMesh own{fragment.mesh.vertices, {}};
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      const glm::uvec3& c = fragment.mesh.triangles[t];
      const bool isTop = isAt(1.0)(fragment.mesh, c);
      EXPECT_TRUE(!isTop || fragment.mesh.neighbor[t] == 0);
      if (isTop) own.triangles.push_back(c);
    }
    top += area(own);
  }
  EXPECT_GT(top, 2.0);  // of 4, less what the cracks have lost
  EXPECT_LT(top, 4.0);
}

}  // namespace
}  // namespace sherd
