// The union of the bodies of one mesh.
#include "intersect/arrange/unite.h"

#include <gtest/gtest.h>
#include <sherd/error.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "intersect/arrange/arrangement.h"
#include "intersect/self_crossings.h"
#include "mesh/search/boxes.h"
#include "mesh/search/near_boxes.h"
#include "mesh/search/triangle_tree.h"
#include "remesh/bodies.h"
#include "shapes.h"

namespace sherd {
namespace {

using shapes::append;
using shapes::cube;

// A box between two corners.
TriangleMesh boxAt(const glm::dvec3& low, const glm::dvec3& high) {
  TriangleMesh box = cube(2.0);
  for (glm::dvec3& v : box.vertices) {
    for (int k = 0; k < 3; ++k) v[k] = v[k] < 0.0 ? low[k] : high[k];
  }
  return box;
}

// Vertices at one position become one, as readers of files do it.
TriangleMesh merged(const TriangleMesh& mesh) {
  TriangleMesh out{mesh.vertices, {}};
  const auto first = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(
        std::find(mesh.vertices.begin(), mesh.vertices.end(), mesh.vertices[v]) -
        mesh.vertices.begin());
  };
  for (const glm::uvec3& t : mesh.triangles)
    out.triangles.emplace_back(first(t.x), first(t.y), first(t.z));
  return out;
}

// Vertices minus edges plus triangles.
int eulerNumber(const TriangleMesh& mesh) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<std::uint32_t> used;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
      used.push_back(t[k]);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(used.begin(), used.end());
  const auto count = [](auto& all) {
    return static_cast<int>(std::unique(all.begin(), all.end()) - all.begin());
  };
  return count(used) - count(edges) + static_cast<int>(mesh.triangles.size());
}

struct Expected {
  double volume = 0.0, area = 0.0;
  int euler = 2;
  std::size_t bodies = 1;
};

// Checks a union against mathematics; vertices and edges are those of several sheets where
// `isManifold` is false.
TriangleMesh expectUnion(const TriangleMesh& mesh, const Expected& expected,
                         bool isManifold = true) {
  const UnitedMesh united = unite(mesh);
  EXPECT_EQ(united.failure, "");
  EXPECT_NEAR(volume(united.mesh), expected.volume, 1e-12 * std::abs(expected.volume));
  EXPECT_NEAR(area(united.mesh), expected.area, 1e-12 * expected.area);
  EXPECT_EQ(openEdges(united.mesh), 0u);
  EXPECT_EQ(nonManifoldEdges(united.mesh) == 0, isManifold);
  EXPECT_TRUE(selfCrossings(united.mesh.vertices, united.mesh.triangles).empty());
  if (isManifold) {
    EXPECT_EQ(eulerNumber(united.mesh), expected.euler);
  }
  EXPECT_EQ(bodiesOf(united.mesh).size(), expected.bodies);
  EXPECT_EQ(united.mesh.source.size(), united.mesh.triangles.size());
  return united.mesh;
}

const TriangleMesh kUnit = boxAt({0, 0, 0}, {1, 1, 1});

TEST(Unite, CubesThatOverlap) {
  const TriangleMesh mesh = append(kUnit, boxAt({0.5, 0.25, 0.25}, {1.5, 1.25, 1.25}));
  EXPECT_TRUE(componentsMeet(mesh));
  const double common = 0.5 * 0.75 * 0.75;
  const double area = 12.0 - 2.0 * (0.5 * 0.75 + 0.5 * 0.75 + 0.75 * 0.75);
  expectUnion(mesh, {2.0 - common, area});
}

TEST(Unite, CubesThatShareAFace) {
  const TriangleMesh mesh = merged(append(kUnit, boxAt({1, 0, 0}, {2, 1, 1})));
  expectUnion(mesh, {2.0, 10.0});
  EXPECT_TRUE(componentsMeet(append(kUnit, boxAt({1, 0, 0}, {2, 1, 1}))));
}

TEST(Unite, CubesThatShareAPartOfAFace) {
  for (const glm::dvec3& low : {glm::dvec3(1, 0.3, 0.4), {1, -0.5, 0.25}, {1, 0, 0.7}}) {
    const TriangleMesh mesh = append(kUnit, boxAt(low, low + 1.0));
    EXPECT_TRUE(componentsMeet(mesh));
    const double common = (1.0 - std::abs(low.y)) * (1.0 - std::abs(low.z));
    expectUnion(mesh, {2.0, 12.0 - 2.0 * common});
  }
}

TEST(Unite, ASmallCubeOnALargeOne) {
  const TriangleMesh mesh = append(kUnit, boxAt({1, 0.25, 0.3}, {1.5, 0.75, 0.8}));
  expectUnion(mesh, {1.125, 6.0 + 4.0 * 0.25});
}

TEST(Unite, CubesThatOverlapInPlanes) {  // with faces in the same planes
  const TriangleMesh mesh = append(kUnit, boxAt({0.5, 0, 0}, {1.5, 1, 1}));
  expectUnion(mesh, {1.5, 2.0 + 4.0 * 1.5});
}

TEST(Unite, CubesThatShareAnEdgeAreTwoBodies) {
  const TriangleMesh mesh = merged(append(kUnit, boxAt({1, 1, 0}, {2, 2, 1})));
  expectUnion(mesh, {2.0, 12.0, 0, 2}, false);
  expectUnion(append(kUnit, boxAt({1, 1, 0.5}, {2, 2, 1.5})), {2.0, 12.0, 0, 2}, false);
}

TEST(Unite, CubesThatShareAVertexAreTwoBodies) {
  const TriangleMesh mesh = merged(append(kUnit, boxAt({1, 1, 1}, {2, 2, 2})));
  expectUnion(mesh, {2.0, 12.0, 3, 2});  // two spheres with a common vertex
}

TEST(Unite, AVertexThatTouchesAFace) {
  const TriangleMesh tip{{{0.5, 0.4, 1}, {0, 0, 2}, {1, 0, 2}, {0.5, 1, 2}},
                         {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}}};
  ASSERT_GT(volume(tip), 0.0);
  const TriangleMesh mesh = append(kUnit, tip);
  EXPECT_TRUE(componentsMeet(mesh));
  expectUnion(mesh, {1.0 + volume(tip), 6.0 + area(tip), 3, 2});
}

TEST(Unite, EqualCubesAreOne) {
  expectUnion(merged(append(kUnit, kUnit)), {1.0, 6.0});
  expectUnion(append(append(kUnit, kUnit), kUnit), {1.0, 6.0});
}

TEST(Unite, AnInnerBodyVanishes) {
  const TriangleMesh mesh = append(kUnit, boxAt(glm::dvec3(0.25), glm::dvec3(0.75)));
  EXPECT_TRUE(componentsMeet(mesh));
  const TriangleMesh united = expectUnion(mesh, {1.0, 6.0});
  EXPECT_EQ(united.triangles.size(), kUnit.triangles.size());
}

TEST(Unite, AnInvertedInnerBodyStaysACavity) {
  const TriangleMesh mesh =
      append(kUnit, shapes::inverted(boxAt(glm::dvec3(0.25), glm::dvec3(0.75))));
  EXPECT_FALSE(componentsMeet(mesh));
  expectUnion(mesh, {0.875, 7.5, 4});
}

TEST(Unite, ABodyInACavityStays) {
  const TriangleMesh mesh =
      append(append(kUnit, shapes::inverted(boxAt(glm::dvec3(0.25), glm::dvec3(0.75)))),
             boxAt(glm::dvec3(0.4), glm::dvec3(0.6)));
  EXPECT_FALSE(componentsMeet(mesh));
  expectUnion(mesh, {0.875 + 0.008, 7.5 + 0.24, 6, 2});
}

TEST(Unite, BodiesApartStayBitForBit) {
  const TriangleMesh mesh = append(append(kUnit, boxAt(glm::dvec3(1.5), glm::dvec3(2.5))),
                                   shapes::ball(0.2, 2, {2, 0, 0}));
  EXPECT_FALSE(componentsMeet(mesh));
  const UnitedMesh united = unite(mesh);
  EXPECT_EQ(united.mesh.vertices, mesh.vertices);
  EXPECT_EQ(united.mesh.triangles, mesh.triangles);
}

TEST(Unite, ManyBodiesApartDoNotMeet) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(0.0, 0.9);
  TriangleMesh mesh;
  for (int i = 0; i < 5000; ++i) {  // each in a cell of its own
    const glm::dvec3 low = glm::dvec3(i % 17, i / 17 % 17, i / 17 / 17) +
                           glm::dvec3(uniform(random), uniform(random), uniform(random));
    const TriangleMesh box = boxAt(low, low + 0.09);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), box.vertices.begin(), box.vertices.end());
    for (const glm::uvec3& t : box.triangles) mesh.triangles.push_back(t + first);
  }
  EXPECT_FALSE(componentsMeet(mesh));
  EXPECT_TRUE(componentsMeet(append(mesh, boxAt({3, 3, 3}, {4, 4, 4}))));  // around one
}

TEST(NearBoxes, AreThoseThatMeetAnother) {
  std::mt19937 random(9);
  for (const double size : {0.01, 0.05, 0.4}) {  // of none to all of 5,000
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto draw = [&] { return glm::dvec3(uniform(random), uniform(random), uniform(random)); };
    std::vector<Box> boxes;
    for (int i = 0; i < 5000; ++i) {
      const glm::dvec3 low = draw();
      boxes.push_back({low, low + size * draw()});
    }
    boxes.push_back({{2, 2, 2}, {3, 3, 3}});
    boxes.push_back({{3, 2, 2}, {4, 3, 3}});  // a common face
    boxes.push_back({{2, 4, 2}, {2, 4, 2}});  // a point alone
    std::vector<std::uint8_t> expected(boxes.size(), 0);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (meet(boxes[i], boxes[j])) expected[i] = expected[j] = 1;
      }
    }
    EXPECT_EQ(meetingOthers(boxes), expected);
  }
}

TEST(Unite, AWallOfBricks) {
  for (const double size : {1.0, 0.1, 1.0 / 3.0}) {
    TriangleMesh wall;
    const auto at = [&](int i) { return size * i; };
    for (int i = 0; i < 27; ++i) {
      const int x = i % 3, y = i / 3 % 3, z = i / 9;
      wall = append(wall, boxAt({at(x), at(y), at(z)}, {at(x + 1), at(y + 1), at(z + 1)}));
    }
    expectUnion(merged(wall), {27 * size * size * size, 54 * size * size});
  }
}

TEST(Unite, AWallOfBricksInARunningBond) {
  TriangleMesh wall;
  for (int row = 0; row < 4; ++row) {
    for (int i = 0; i < 4; ++i) {
      const double x = i + 0.5 * (row % 2);
      wall = append(wall, boxAt({x, 0, 0.5 * row}, {x + 1, 0.5, 0.5 * row + 0.5}));
    }
  }
  EXPECT_TRUE(componentsMeet(merged(wall)));
  // 4 rows of 4 * 0.5 * 0.5; fronts, both ends, top and bottom, and the steps of half a brick.
  expectUnion(merged(wall), {4.0, 2 * 4.0 * 2.0 + 2 * 2.0 * 0.5 + 2 * 4.0 * 0.5 + 3 * 2 * 0.25});
}

glm::dmat3 randomRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return glm::dvec3(normal(random), normal(random), normal(random)); };
  const glm::dvec3 x = glm::normalize(draw()), z = glm::normalize(glm::cross(x, draw()));
  return {x, glm::cross(z, x), z};
}

// The volume of a union of boxes, by the share of random points that are in one.
TEST(Unite, TwentyRotatedBoxes) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  struct Placed {
    glm::dmat3 rotation;
    glm::dvec3 center;
  };
  constexpr double kHalf = 0.5;
  std::vector<Placed> boxes;
  TriangleMesh mesh;
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 center(uniform(random), uniform(random), uniform(random));
    boxes.push_back({randomRotation(random), center});
    TriangleMesh box = cube(2.0 * kHalf);
    for (glm::dvec3& v : box.vertices) v = boxes.back().rotation * v + center;
    mesh = append(mesh, box);
  }
  const UnitedMesh united = unite(mesh);
  ASSERT_EQ(united.failure, "");
  EXPECT_EQ(nonManifoldEdges(united.mesh), 0u);
  EXPECT_TRUE(selfCrossings(united.mesh.vertices, united.mesh.triangles).empty());
  const TriangleTree tree(united.mesh);
  constexpr int kPoints = 4000;
  int different = 0;
  for (int i = 0; i < kPoints; ++i) {
    const glm::dvec3 p = 2.0 * glm::dvec3(uniform(random), uniform(random), uniform(random));
    const bool isInside = std::any_of(boxes.begin(), boxes.end(), [&](const Placed& box) {
      const glm::dvec3 own = glm::abs((p - box.center) * box.rotation);
      return std::max({own.x, own.y, own.z}) < kHalf;
    });
    if (isInside != (tree.winding(p) >= 0.5)) ++different;
  }
  EXPECT_EQ(different, 0);
}

TEST(Unite, TwoRotatedBoxesHaveAllPartsOfTheirFaces) {
  std::mt19937 random(11);
  for (int i = 0; i < 20; ++i) {
    TriangleMesh box = cube(1.0);
    const glm::dmat3 rotation = randomRotation(random);
    for (glm::dvec3& v : box.vertices) v = rotation * v + glm::dvec3(0.3, 0.4, 0.2);
    const TriangleMesh both = append(cube(1.0), box);
    // What the union and the intersection leave out of each other is what the bodies have.
    const TriangleMesh inverse = append(shapes::inverted(cube(1.0)), box);
    const UnitedMesh sum = unite(both), difference = unite(inverse);  // box minus the cube
    ASSERT_EQ(sum.failure, "");
    ASSERT_EQ(difference.failure, "");
    EXPECT_NEAR(volume(sum.mesh), 1.0 + volume(difference.mesh), 1e-13);
    EXPECT_EQ(eulerNumber(sum.mesh), 2);
    EXPECT_EQ(nonManifoldEdges(sum.mesh), 0u);
  }
}

TEST(Unite, BallsKeepTrianglesThatNothingTouches) {
  const TriangleMesh a = shapes::ball(1.0, 4), b = shapes::ball(1.0, 4, {1.1, 0.2, 0.1});
  const TriangleMesh mesh = append(a, b);
  const UnitedMesh united = unite(mesh);
  ASSERT_EQ(united.failure, "");
  EXPECT_EQ(nonManifoldEdges(united.mesh), 0u);
  EXPECT_EQ(eulerNumber(united.mesh), 2);
  // The caps within the other ball: pi h^2 (3 r - h) / 3, of polyhedra 0.3 % below the balls.
  const double h = 1.0 - glm::length(glm::dvec3(1.1, 0.2, 0.1)) / 2.0;
  const double expected = 2.0 * (shapes::ballVolume(1.0) - M_PI * h * h * (3.0 - h) / 3.0);
  EXPECT_NEAR(volume(united.mesh), expected, 0.005 * expected);
  std::size_t whole = 0;
  for (std::size_t t = 0; t < united.mesh.triangles.size(); ++t) {
    const glm::uvec3 &own = united.mesh.triangles[t],
                     &source = mesh.triangles[united.mesh.source[t]];
    bool isSame = true;
    for (int k = 0; k < 3; ++k)
      isSame = isSame && united.mesh.vertices[own[k]] == mesh.vertices[source[k]];
    whole += isSame ? 1 : 0;
  }
  EXPECT_GT(whole, united.mesh.triangles.size() / 2);
}

// Bricks at sums of steps, which differ by rounding from those of their neighbors, rotated so that
// no two faces are in one plane.
TEST(Unite, WallsThatTouchButForRounding) {
  std::mt19937 random(3);
  for (const double jitter : {0.0, 1e-16, 1e-13, 1e-9}) {
    std::uniform_real_distribution<double> noise(-jitter, jitter);
    TriangleMesh wall;
    for (int i = 0; i < 12; ++i) {
      const int row = i / 4;
      const double x = (i % 4) * 0.3 + 0.15 * (row % 2), z = row * 0.1;
      wall = append(wall, boxAt({x, 0, z}, {x + 0.3, 0.2, z + 0.1}));
    }
    const glm::dmat3 rotation = randomRotation(random);
    for (glm::dvec3& v : wall.vertices) {
      v = rotation * v + glm::dvec3(noise(random), noise(random), noise(random));
    }
    const UnitedMesh united = unite(wall);
    ASSERT_EQ(united.failure, "") << jitter;
    EXPECT_EQ(openEdges(united.mesh), 0u);
    EXPECT_TRUE(selfCrossings(united.mesh.vertices, united.mesh.triangles).empty());
    // Single precision is the coarsest grid that vertices may be moved to.
    EXPECT_NEAR(volume(united.mesh), 12 * 0.3 * 0.2 * 0.1, 1e-6);
  }
}

TEST(Unite, EqualBodiesButForRounding) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> noise(-4e-16, 4e-16);
  for (int i = 0; i < 20; ++i) {
    TriangleMesh box = cube(1.0);
    const glm::dmat3 rotation = randomRotation(random);
    for (glm::dvec3& v : box.vertices) v = rotation * v + glm::dvec3(1, 2, 3);
    TriangleMesh other = box;
    for (glm::dvec3& v : other.vertices)
      v += glm::dvec3(noise(random), noise(random), noise(random));
    const UnitedMesh united = unite(append(box, other));
    ASSERT_EQ(united.failure, "");
    EXPECT_NEAR(volume(united.mesh), 1.0, 1e-6);
    EXPECT_EQ(openEdges(united.mesh), 0u);
  }
}

TEST(Unite, ABodyThatCrossesItself) {
  // A bar that is bent through itself: four boxes around a hole, as one component by a shared edge.
  TriangleMesh mesh = append(boxAt({0, 0, 0}, {3, 1, 1}), boxAt({0, 2, 0}, {3, 3, 1}));
  mesh = append(mesh, boxAt({0, 0, 0}, {1, 3, 1}));
  mesh = append(mesh, boxAt({2, 0, 0}, {3, 3, 1}));
  expectUnion(merged(mesh), {8.0, 2 * 8.0 + 12.0 + 4.0, 0});
}

TEST(Unite, TrianglesWithoutAreaAreLeftOut) {
  TriangleMesh mesh = append(kUnit, boxAt({0.5, 0.25, 0.25}, {1.5, 1.25, 1.25}));
  // The first edge is split for one of its triangles, and a triangle without area fills the gap.
  const glm::uvec3 t = mesh.triangles[0];
  const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back((mesh.vertices[t.x] + mesh.vertices[t.y]) / 2.0);
  mesh.triangles[0] = {t.x, middle, t.z};
  mesh.triangles.emplace_back(middle, t.y, t.z);
  mesh.triangles.emplace_back(t.x, t.y, middle);
  ASSERT_EQ(openEdges(mesh), 0u);
  expectUnion(mesh, {2.0 - 0.5 * 0.75 * 0.75, 12.0 - 2.0 * (0.75 + 0.5625)});
}

// Lines through a triangle, along x and y, that end within it.
struct Lattice {
  std::array<glm::dvec3, 3> corners{glm::dvec3(0, 0, 0), {9, 0, 0}, {0, 9, 0}};
  PointSet points{corners};
  std::vector<ArrangedLine> lines;

  explicit Lattice(int count) {
    for (std::uint32_t corner = 0; corner < 3; ++corner) points.addVertex(corner);
    for (int i = 0; i < count; ++i) {
      const double at = 1.0 + i / 64.0;
      for (const bool isAlongX : {true, false}) {
        const auto add = [&](double along) {
          return points.add(
              ExactPoint(isAlongX ? glm::dvec3(along, at, 0) : glm::dvec3(at, along, 0)));
        };
        const std::uint32_t from = add(0.5), to = add(3.0);
        lines.push_back({from, to});
      }
    }
  }
};

std::string arranged(Lattice& lattice, std::vector<ArrangedTriangle>& out,
                     const Progress* progress = nullptr) {
  const std::vector<PlaneTriangle> whole{{0, {0, 1, 2}}};
  return arrangePlane(whole, lattice.lines, {}, lattice.points, out, progress);
}

TEST(Unite, CrossingsInOnePlaneAreBounded) {
  for (const int count : {8, 64, 65}) {
    Lattice lattice(count);
    std::vector<ArrangedTriangle> parts;
    const std::string failure = arranged(lattice, parts);
    if (count * count > 4096) {
      EXPECT_EQ(failure, "triangles cross each other more than 4096 times in one plane");
      EXPECT_TRUE(parts.empty());
      continue;
    }
    EXPECT_EQ(failure, "");
    // A triangulation of points inside a triangle has 2 points + 1 triangles.
    EXPECT_EQ(parts.size(), static_cast<std::size_t>(2 * (4 * count + count * count) + 1));
  }
}

TEST(Unite, ThatTrianglesCrossTooOftenIsTheReason) {
  // A triangle, and others upright through it, along x and y.
  std::vector<glm::dvec3> vertices{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}};
  std::vector<glm::uvec3> triangles{{0, 1, 2}};
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (int i = 0; i < 130; ++i) {
    const double at = 1.0 + i / 2 / 64.0;
    for (const glm::dvec3& corner : {glm::dvec3(-1, at, -1), {5, at, -1}, {2, at, 1}}) {
      vertices.push_back(i % 2 == 0 ? corner : glm::dvec3(corner.y, corner.x, corner.z));
    }
    const auto last = static_cast<std::uint32_t>(vertices.size() - 1);
    triangles.emplace_back(last - 2, last - 1, last);
    pairs.push_back({0, static_cast<std::uint32_t>(i + 1)});
  }
  PointSet points(vertices);
  std::vector<std::uint8_t> isDivided;
  const Arrangement all = arrangementOf(vertices, triangles, pairs, points, isDivided, nullptr);
  EXPECT_EQ(all.failure, "triangles cross each other more than 4096 times in one plane");
  EXPECT_TRUE(all.parts.empty());
}

TEST(Unite, ThatNothingIsInsideIsTheReason) {
  const UnitedMesh united = unite(append(kUnit, shapes::inverted(kUnit)));
  EXPECT_EQ(united.failure, "the mesh has no inside");
}

// Runs work that is cancelled at one of the polls, and returns the number of polls without that.
template <class Work>
std::size_t expectCancelled(const Work& work) {
  std::atomic<std::size_t> polls{0};
  const Progress never{.report = {}, .cancelled = [&] { return ++polls, false; }};
  work(&never);
  const std::size_t all = polls;
  for (const std::size_t at : {std::size_t{1}, all / 3 + 1, all * 2 / 3 + 1, all}) {
    polls = 0;
    const Progress then{.report = {}, .cancelled = [&] { return ++polls >= at; }};
    try {
      work(&then);
      ADD_FAILURE() << "not cancelled at poll " << at << " of " << all;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
    EXPECT_LE(polls, at + 64);  // as many threads may be at work
  }
  return all;
}

TEST(Unite, ACancelEndsTheDivisionOfAPlane) {
  const std::size_t polls = expectCancelled([](const Progress* progress) {
    Lattice lattice(32);
    std::vector<ArrangedTriangle> parts;
    EXPECT_EQ(arranged(lattice, parts, progress), "");
  });
  EXPECT_GE(polls, 2u * 32u * 32u);  // where each crossing is made, and where it is triangulated
}

TEST(Unite, ProgressHasSteps) {
  const TriangleMesh balls = append(shapes::ball(1.0, 4), shapes::ball(1.0, 4, {1.1, 0.2, 0.1}));
  const TriangleMesh cubes = append(kUnit, boxAt(glm::dvec3(2.0), glm::dvec3(3.0)));
  for (const auto& [mesh, least] : {std::pair(balls, 8u), {cubes, 3u}}) {
    std::vector<double> fractions;
    const Progress progress{.report =
                                [&](std::string_view stage, double fraction) {
                                  EXPECT_EQ(stage, "unite");
                                  fractions.push_back(fraction);
                                },
                            .cancelled = {}};
    EXPECT_EQ(unite(mesh, &progress).failure, "");
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_EQ(fractions.front(), 0.0);
    EXPECT_EQ(fractions.back(), 1.0);
    fractions.erase(std::unique(fractions.begin(), fractions.end()), fractions.end());
    EXPECT_GE(fractions.size(), least);
  }
}

TEST(Unite, ACancelEndsIt) {
  TriangleMesh mesh;
  for (int i = 0; i < 6; ++i) {
    mesh = append(mesh, boxAt({0.3 * i, 0.1 * i, 0.2 * i}, glm::dvec3(1.0 + 0.25 * i)));
  }
  expectCancelled([&](const Progress* progress) { EXPECT_EQ(unite(mesh, progress).failure, ""); });
}

}  // namespace
}  // namespace sherd
