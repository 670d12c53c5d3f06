// Faces, vertices, corners and neighbors of bodies of which they are known.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/evaluate.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "evaluate/cracks/crack_faces.h"
#include "mesh/largest_axis.h"
#include "mesh/plane_moments.h"
#include "mesh/symmetric_eigen.h"
#include "shapes.h"

namespace sherd {
namespace {

constexpr std::size_t kFew = 20;  // simulations, where p-values do not matter

FragmentSet setOf(const std::vector<TriangleMesh>& meshes) {
  FragmentSet set;
  for (const TriangleMesh& mesh : meshes) {
    EvaluatedFragment& fragment = set.fragments.emplace_back();
    fragment.mesh = {static_cast<int>(set.fragments.size()), mesh};
  }
  return set;
}

/// A side of a prism: where it begins, and its neighbor.
struct Side {
  glm::dvec2 from;
  int neighbor;
};

// A prism on a convex polygon, counter-clockwise, between two heights.  Vertices are shared.
TriangleMesh prism(const std::vector<Side>& sides, double low, double high, int below, int above) {
  TriangleMesh mesh;
  const auto n = static_cast<unsigned>(sides.size());
  for (const double z : {low, high}) {
    for (const Side& side : sides) mesh.vertices.emplace_back(side.from, z);
    glm::dvec2 middle(0.0);
    for (const Side& side : sides) middle += side.from / static_cast<double>(n);
    mesh.vertices.emplace_back(middle, z);
  }
  const auto add = [&](unsigned a, unsigned b, unsigned c, int neighbor) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.neighbor.push_back(static_cast<std::uint16_t>(neighbor));
  };
  for (unsigned i = 0; i < n; ++i) {
    const unsigned next = (i + 1) % n, up = n + 1;
    add(i, next, up + next, sides[i].neighbor);
    add(i, up + next, up + i, sides[i].neighbor);
    add(n, next, i, below);
    add(up + n, up + i, up + next, above);
  }
  return mesh;
}

// The boxes of a block of 3 x 3 x 3, 27 is the number of the last; moved apart by a gap.
std::vector<TriangleMesh> block(double gap = 0.0) {
  std::vector<TriangleMesh> meshes;
  const auto id = [](int x, int y, int z) {
    const bool inside = std::min({x, y, z}) >= 0 && std::max({x, y, z}) < 3;
    return inside ? 1 + x + 3 * y + 9 * z : 0;
  };
  for (int i = 0; i < 27; ++i) {
    const int x = i % 3, y = i / 3 % 3, z = i / 9;
    const double a = x + gap, b = x + 1 - gap, c = y + gap, d = y + 1 - gap;
    meshes.push_back(prism({{{a, c}, id(x, y - 1, z)},
                            {{b, c}, id(x + 1, y, z)},
                            {{b, d}, id(x, y + 1, z)},
                            {{a, d}, id(x - 1, y, z)}},
                           z + gap, z + 1 - gap, id(x, y, z - 1), id(x, y, z + 1)));
  }
  return meshes;
}

void expectTheBlock(const FractureStatistics& found) {
  ASSERT_TRUE(found.interiorFaces && found.interiorVertices && found.interiorNeighbors);
  EXPECT_EQ(found.interiorFaces->count, 1u);
  EXPECT_EQ(found.interiorFaces->mean, 6.0);
  EXPECT_EQ(found.interiorVertices->mean, 8.0);
  EXPECT_EQ(found.interiorNeighbors->mean, 6.0);
  for (const FragmentShape& shape : found.fragments) {
    EXPECT_EQ(shape.flatFaces, 6u) << shape.id;
    EXPECT_EQ(shape.flatVertices, 8u) << shape.id;
    EXPECT_NEAR(shape.share, 1.0 / 27.0, 1e-12);
    EXPECT_NEAR(shape.breakShare, static_cast<double>(shape.faces) / 6.0, 1e-9);
  }
  const FragmentShape& corner = found.fragments[0];  // three cracks, which meet in one point
  EXPECT_EQ(corner.faces, 3u);
  EXPECT_EQ(corner.vertices, 1u);
  EXPECT_EQ(corner.neighbors, 3u);
  EXPECT_NEAR(found.faces->mean, 2.0 * 54.0 / 27.0, 1e-12);  // 54 walls between boxes
  EXPECT_EQ(found.flatFaces->mean, 6.0);
  EXPECT_EQ(found.rule, FaceRule::planes);
  ASSERT_TRUE(found.orientation);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR((*found.orientation)[i], 1.0 / 3.0, 1e-12);
}

TEST(Statistics, OfABlockOfCubes) {
  const FractureStatistics found = statistics(setOf(block()), {.simulations = kFew});
  EXPECT_TRUE(found.knownNeighbors);
  expectTheBlock(found);
}

TEST(Statistics, FindNeighborsByDistance) {
  std::vector<TriangleMesh> meshes = block(0.005);
  for (TriangleMesh& mesh : meshes) mesh.neighbor.clear();
  const FractureStatistics found = statistics(setOf(meshes), {.simulations = kFew});
  EXPECT_FALSE(found.knownNeighbors);
  expectTheBlock(found);
}

// Bricks in running bond: each long side has two neighbors, and is one face.
//
//     +----+----+----+
//     |  6 |  7 |  8 |
//     +--+-+--+-+--+-+
//        | 3  | 4  | 5
//     +--+-+--+-+--+-+
//     |  0 |  1 |  2 |
TEST(Statistics, AFaceMayHaveTwoNeighbors) {
  const TriangleMesh brick =
      prism({{{0, 0}, 1}, {{1, 0}, 2}, {{2, 0}, 3}, {{2, 1}, 4}, {{1, 1}, 5}, {{0, 1}, 6}}, 0.0,
            0.2, 0, 0);
  const TriangleMesh far =
      shapes::withNeighbor(shapes::cube(0.2, {20.0, 20.0, 0.1}), std::vector<std::uint16_t>(12, 0));
  const FractureStatistics found = statistics(setOf({brick, far}), {.simulations = kFew});
  const FragmentShape& shape = found.fragments[0];
  EXPECT_EQ(shape.faces, 4u);
  EXPECT_EQ(shape.neighbors, 6u);
  EXPECT_EQ(found.thinAxis, 2);
  EXPECT_EQ(shape.corners, 4u);
  EXPECT_FALSE(found.fragments[1].corners);  // all rim
  const FractureStatistics contacts =
      statistics(setOf({brick, far}), {.faces = FaceRule::neighbors, .simulations = kFew});
  EXPECT_EQ(contacts.fragments[0].faces, 6u);
  EXPECT_EQ(contacts.fragments[0].corners, 6u);
}

// A square whose one corner is cut off by the rim of the plate, a fourteenth as wide as it is
// thick.
TEST(Statistics, ANarrowPartOfTheRimIsRim) {
  const auto cornersWith = [](int neighborOfCorner) {
    const TriangleMesh square = prism(
        {{{0, 0}, 1}, {{1, 0}, 2}, {{1, 0.99}, neighborOfCorner}, {{0.99, 1}, 3}, {{0, 1}, 4}}, 0.0,
        0.2, 0, 0);
    return statistics(setOf({square}), {.simulations = kFew}).fragments[0].corners;
  };
  EXPECT_EQ(cornersWith(5), 5u);
  EXPECT_FALSE(cornersWith(0));
}

TEST(Statistics, OfAHexagonalPrism) {
  std::vector<Side> hexagon;
  for (int i = 0; i < 6; ++i) {
    const double angle = std::numbers::pi / 3.0 * i;
    hexagon.push_back({{std::cos(angle), std::sin(angle)}, i + 2});
  }
  const FractureStatistics plate =
      statistics(setOf({prism(hexagon, 0.0, 0.3, 0, 0)}), {.simulations = kFew});
  EXPECT_EQ(plate.fragments[0].faces, 6u);
  EXPECT_EQ(plate.fragments[0].flatFaces, 8u);
  EXPECT_EQ(plate.fragments[0].flatVertices, 12u);
  EXPECT_EQ(plate.corners->mean, 6.0);
  const FractureStatistics inside =
      statistics(setOf({prism(hexagon, 0.0, 2.0, 8, 9)}), {.simulations = kFew});
  EXPECT_EQ(inside.interiorFaces->mean, 8.0);
  EXPECT_EQ(inside.interiorVertices->mean, 12.0);
  EXPECT_EQ(inside.interiorNeighbors->mean, 8.0);
  EXPECT_FALSE(inside.corners);
  EXPECT_EQ(inside.breakShare, 1.0);
}

/// An axis-aligned box of a block that is cut again and again.
struct Brick {
  glm::dvec3 low, high;
  bool contains(const glm::dvec3& p) const {
    return glm::all(glm::lessThan(low, p)) && glm::all(glm::lessThan(p, high));
  }
};

// The largest box is cut across its longest side, near the middle: 500 boxes, of which a face has
// several neighbors, since each crack ends at the border of its box.
//   parents  [splits] as FragmentSet::splitParents
//   splits   [boxes] as EvaluatedFragment::split
std::vector<Brick> cutBlock(std::size_t count, std::vector<int>& parents,
                            std::vector<int>& splits) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> share(0.35, 0.65);
  std::vector<Brick> boxes{{glm::dvec3(0.0), glm::dvec3(1.0)}};
  splits = {0};
  const auto volumeOf = [](const Brick& b) {
    const glm::dvec3 size = b.high - b.low;
    return size.x * size.y * size.z;
  };
  while (boxes.size() < count) {
    const auto largest =
        std::max_element(boxes.begin(), boxes.end(),
                         [&](const Brick& a, const Brick& b) { return volumeOf(a) < volumeOf(b); });
    const glm::dvec3 size = largest->high - largest->low;
    const int axis = largestAxis(size);
    Brick upper = *largest;
    upper.low[axis] = largest->low[axis] + share(random) * size[axis];
    largest->high[axis] = upper.low[axis];
    int& split = splits[static_cast<std::size_t>(largest - boxes.begin())];
    parents.push_back(split);
    split = static_cast<int>(parents.size());
    splits.push_back(split);
    boxes.push_back(upper);
  }
  return boxes;
}

// A box whose sides are grids: lines where any other box has a side, so that a quad has one
// neighbor.
TriangleMesh gridOf(const Brick& box, const std::vector<Brick>& all) {
  std::array<std::vector<double>, 3> ticks;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double>& at = ticks[static_cast<std::size_t>(axis)];
    for (const Brick& other : all) {
      if (glm::any(glm::greaterThan(other.low, box.high)) ||
          glm::any(glm::lessThan(other.high, box.low))) {
        continue;
      }
      for (const double value : {other.low[axis], other.high[axis]}) {
        if (value >= box.low[axis] && value <= box.high[axis]) at.push_back(value);
      }
    }
    std::sort(at.begin(), at.end());
    at.erase(std::unique(at.begin(), at.end()), at.end());
  }
  TriangleMesh mesh;
  std::map<std::array<double, 3>, unsigned> known;
  const auto vertex = [&](const glm::dvec3& p) {
    const auto [place, fresh] =
        known.try_emplace({p.x, p.y, p.z}, static_cast<unsigned>(mesh.vertices.size()));
    if (fresh) mesh.vertices.push_back(p);
    return place->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const std::vector<double>&a = ticks[static_cast<std::size_t>(u)],
          &b = ticks[static_cast<std::size_t>(v)];
    for (const bool top : {false, true}) {
      for (std::size_t i = 0; i + 1 < a.size(); ++i) {
        for (std::size_t k = 0; k + 1 < b.size(); ++k) {
          glm::dvec3 p((top ? box.high : box.low)[axis]), outside;
          outside[axis] = p[axis] + (top ? 1e-9 : -1e-9);
          outside[u] = 0.5 * (a[i] + a[i + 1]);
          outside[v] = 0.5 * (b[k] + b[k + 1]);
          const auto at = [&](std::size_t x, std::size_t y) {
            p[u] = a[x];
            p[v] = b[y];
            return vertex(p);
          };
          const unsigned c[] = {at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)};
          mesh.triangles.emplace_back(c[0], c[top ? 1 : 2], c[top ? 2 : 1]);
          mesh.triangles.emplace_back(c[0], c[top ? 2 : 3], c[top ? 3 : 2]);
          const auto behind = std::find_if(all.begin(), all.end(),
                                           [&](const Brick& o) { return o.contains(outside); });
          const auto id = behind == all.end() ? 0 : behind - all.begin() + 1;
          mesh.neighbor.insert(mesh.neighbor.end(), 2, static_cast<std::uint16_t>(id));
        }
      }
    }
  }
  return mesh;
}

TEST(Statistics, TJunctionsLowerFacesAndNotNeighbors) {
  std::vector<int> parents, splits;
  const std::vector<Brick> boxes = cutBlock(500, parents, splits);
  std::vector<TriangleMesh> meshes;
  for (const Brick& box : boxes) meshes.push_back(gridOf(box, boxes));
  const FractureStatistics found = statistics(setOf(meshes), {.unit = 1e-6, .simulations = kFew});
  double neighbors = 0.0, interior = 0.0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const FragmentShape& shape = found.fragments[i];
    std::set<std::uint16_t> ids(meshes[i].neighbor.begin(), meshes[i].neighbor.end());
    EXPECT_EQ(shape.interior, !ids.contains(0));
    ids.erase(0);
    EXPECT_EQ(shape.neighbors, ids.size()) << i;
    EXPECT_EQ(shape.flatFaces, 6u) << i;
    EXPECT_EQ(shape.flatVertices, 8u) << i;
    if (!shape.interior) continue;
    neighbors += static_cast<double>(ids.size());
    interior += 1.0;
  }
  EXPECT_EQ(found.interiorFaces->mean, 6.0);
  EXPECT_EQ(found.interiorVertices->mean, 8.0);
  EXPECT_NEAR(found.interiorNeighbors->mean, neighbors / interior, 1e-9);
  EXPECT_GT(found.interiorNeighbors->mean, 12.0);

  // The same by the tree of cuts, also with tilted sides, which are in no plane
  FragmentSet set = setOf(meshes);
  set.splitParents = parents;
  for (std::size_t i = 0; i < boxes.size(); ++i) set.fragments[i].split = splits[i];
  for (EvaluatedFragment& fragment : set.fragments) {
    for (glm::dvec3& p : fragment.mesh.mesh.vertices)
      p.z += 0.05 * std::sin(40.0 * p.x + 30.0 * p.y);
  }
  const FractureStatistics bySplits = statistics(set, {.unit = 1e-6, .simulations = kFew});
  EXPECT_EQ(bySplits.rule, FaceRule::splits);
  EXPECT_EQ(bySplits.interiorFaces->mean, 6.0);
  EXPECT_EQ(bySplits.interiorVertices->mean, 8.0);
}

/// Half spaces dot(normal, x) <= offset.
struct HalfSpace {
  glm::dvec3 normal;
  double offset;
  int neighbor;
};

/// A convex polyhedron, by all points in which three of its planes meet.
struct Polyhedron {
  TriangleMesh mesh;
  std::size_t faces = 0, cracks = 0;
};
Polyhedron intersectionOf(const std::vector<HalfSpace>& spaces) {
  Polyhedron result;
  std::vector<std::vector<unsigned>> corners(spaces.size());
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        const glm::dmat3 m =
            glm::transpose(glm::dmat3(spaces[i].normal, spaces[j].normal, spaces[k].normal));
        if (std::abs(glm::determinant(m)) < 1e-12) continue;
        const glm::dvec3 p =
            glm::inverse(m) * glm::dvec3(spaces[i].offset, spaces[j].offset, spaces[k].offset);
        if (std::any_of(spaces.begin(), spaces.end(), [&](const HalfSpace& s) {
              return glm::dot(s.normal, p) > s.offset + 1e-11;
            })) {
          continue;
        }
        for (const std::size_t s : {i, j, k}) {
          corners[s].push_back(static_cast<unsigned>(result.mesh.vertices.size()));
        }
        result.mesh.vertices.push_back(p);
      }
    }
  }
  for (std::size_t s = 0; s < spaces.size(); ++s) {
    std::vector<unsigned>& face = corners[s];
    if (face.size() < 3) continue;
    ++result.faces;
    result.cracks += spaces[s].neighbor != 0;
    const glm::dvec3 a = result.mesh.vertices[face[0]], n = glm::normalize(spaces[s].normal);
    std::sort(face.begin() + 1, face.end(), [&](unsigned x, unsigned y) {
      return glm::dot(n, glm::cross(result.mesh.vertices[x] - a, result.mesh.vertices[y] - a)) >
             0.0;
    });
    for (std::size_t i = 2; i < face.size(); ++i) {
      result.mesh.triangles.emplace_back(face[0], face[i - 1], face[i]);
      result.mesh.neighbor.push_back(static_cast<std::uint16_t>(spaces[s].neighbor));
    }
  }
  return result;
}

// Cells of a Voronoi diagram in a cube are simple polyhedra: 2 faces - 4 vertices.
TEST(Statistics, OfVoronoiCells) {
  constexpr int kCells = 40;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit;
  std::vector<glm::dvec3> seeds(kCells);
  for (glm::dvec3& seed : seeds) seed = {unit(random), unit(random), unit(random)};
  std::vector<Polyhedron> cells;
  std::vector<TriangleMesh> meshes;
  for (int i = 0; i < kCells; ++i) {
    std::vector<HalfSpace> spaces;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 e(0.0);
      e[axis] = 1.0;
      spaces.push_back({e, 1.0, 0});
      spaces.push_back({-e, 0.0, 0});
    }
    const glm::dvec3 a = seeds[static_cast<std::size_t>(i)];
    for (int k = 0; k < kCells; ++k) {
      const glm::dvec3 b = seeds[static_cast<std::size_t>(k)];
      if (k != i) spaces.push_back({b - a, 0.5 * (glm::dot(b, b) - glm::dot(a, a)), k + 1});
    }
    cells.push_back(intersectionOf(spaces));
    meshes.push_back(cells.back().mesh);
  }
  const FractureStatistics found =
      statistics(setOf(meshes), {.unit = 1e-7, .leastFace = 0.0, .simulations = kFew});
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const FragmentShape& shape = found.fragments[i];
    EXPECT_EQ(shape.faces, cells[i].cracks) << i;
    EXPECT_EQ(shape.neighbors, cells[i].cracks) << i;
    EXPECT_EQ(shape.flatFaces, cells[i].faces) << i;
    EXPECT_EQ(shape.flatVertices, cells[i].mesh.vertices.size()) << i;
    EXPECT_EQ(shape.flatVertices, 2 * shape.flatFaces - 4) << i;
  }
}

// A cube's sides as grids of triangles, with noise as that of extracted meshes.
TEST(Statistics, PlanesMayBeUneven) {
  constexpr int kSide = 24;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> noise(-0.05, 0.05);
  TriangleMesh mesh;
  std::vector<int> index(static_cast<std::size_t>(std::pow(kSide + 1, 3)), -1);
  const auto vertex = [&](glm::ivec3 p) {
    int& known = index[static_cast<std::size_t>((p.x * (kSide + 1) + p.y) * (kSide + 1) + p.z)];
    if (known < 0) {
      known = static_cast<int>(mesh.vertices.size());
      mesh.vertices.push_back(glm::dvec3(p) +
                              glm::dvec3(noise(random), noise(random), noise(random)));
    }
    return static_cast<unsigned>(known);
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int level : {0, kSide}) {
      for (int a = 0; a < kSide; ++a) {
        for (int b = 0; b < kSide; ++b) {
          const auto at = [&](int i, int k) {
            glm::ivec3 p(0);
            p[axis] = level;
            p[(axis + 1) % 3] = a + i;
            p[(axis + 2) % 3] = b + k;
            return vertex(p);
          };
          mesh.triangles.emplace_back(at(0, 0), at(1, 0), at(1, 1));
          mesh.triangles.emplace_back(at(0, 0), at(1, 1), at(0, 1));
          if (level == 0) {
            for (std::size_t t = mesh.triangles.size() - 2; t < mesh.triangles.size(); ++t) {
              std::swap(mesh.triangles[t].y, mesh.triangles[t].z);
            }
          }
        }
      }
    }
  }
  mesh.neighbor.assign(mesh.triangles.size(), 9);  // one neighbor, behind all six planes
  const FractureStatistics found =
      statistics(setOf({mesh}), {.faces = FaceRule::planes, .unit = 1.0, .simulations = kFew});
  EXPECT_EQ(found.fragments[0].faces, 6u);
  EXPECT_EQ(found.fragments[0].vertices, 8u);
  EXPECT_EQ(found.fragments[0].neighbors, 1u);
}

// A splinter thinner than the tolerance has two sides, of which neither is in the other's plane.
TEST(Statistics, SidesOfASplinterAreTwoFaces) {
  const TriangleMesh splinter =
      prism({{{0, 0}, 1}, {{10, 0}, 2}, {{10, 10}, 3}, {{0, 10}, 4}}, 0.0, 0.02, 5, 6);
  const FractureStatistics found =
      statistics(setOf({splinter}), {.unit = 1.0, .simulations = kFew});
  EXPECT_EQ(found.fragments[0].faces, 2u);
}

TEST(Statistics, RoughCracksHaveExponents) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<TriangleMesh> halves(2);
  constexpr unsigned kSide = 130;
  for (unsigned y = 0; y <= kSide; ++y) {
    for (unsigned x = 0; x <= kSide; ++x) {
      halves[0].vertices.emplace_back(x, y, noise(random));
    }
  }
  for (unsigned y = 0; y < kSide; ++y) {
    for (unsigned x = 0; x < kSide; ++x) {
      const unsigned i = y * (kSide + 1) + x;
      halves[0].triangles.emplace_back(i, i + 1, i + kSide + 2);
      halves[0].triangles.emplace_back(i, i + kSide + 2, i + kSide + 1);
    }
  }
  halves[1] = shapes::inverted(halves[0]);
  halves[0].neighbor.assign(halves[0].triangles.size(), 2);
  halves[1].neighbor.assign(halves[0].triangles.size(), 1);
  const FractureStatistics found = statistics(setOf(halves), {.unit = 1.0, .simulations = kFew});
  EXPECT_LT(found.planeShare, 0.1);
  EXPECT_EQ(found.rule, FaceRule::facets);
  EXPECT_EQ(found.fragments[0].faces, 1u);
  std::vector<TriangleMesh> bare = halves;
  for (TriangleMesh& mesh : bare) mesh.neighbor.clear();
  const FractureStatistics byDistance = statistics(setOf(bare), {.unit = 1.0, .simulations = kFew});
  EXPECT_EQ(byDistance.rule, FaceRule::facets);
  EXPECT_NEAR(byDistance.planeShare, found.planeShare, 1e-9);
  EXPECT_NEAR(byDistance.roughness.value(), found.roughness.value(), 1e-9);
  std::vector<TriangleMesh> far = halves;
  for (TriangleMesh& mesh : far) {
    for (glm::dvec3& p : mesh.vertices) p += glm::dvec3(3e7, -5e7, 2e7);
  }
  const FractureStatistics there = statistics(setOf(far), {.unit = 1.0, .simulations = kFew});
  EXPECT_NEAR(there.roughness.value(), found.roughness.value(), 1e-6);
  EXPECT_NEAR(there.planeShare, found.planeShare, 1e-6);
  ASSERT_EQ(found.hurst.size(), 2u);  // along x and y; z is across the crack
  EXPECT_EQ(found.hurst[0].cracks, 1u);
  EXPECT_NEAR(found.hurst[0].hurst, 0.0, 0.02);  // white noise
  const FractureStatistics directed = statistics(
      setOf(halves), {.unit = 1.0, .propagation = glm::dvec3(0, 2, 0), .simulations = kFew});
  ASSERT_EQ(directed.hurst.size(), 2u);
  EXPECT_EQ(directed.hurst[0].direction, "propagation");
  EXPECT_EQ(directed.hurst[0].hurst, found.hurst[1].hurst);
  EXPECT_NEAR(directed.hurst[1].hurst, found.hurst[0].hurst, 1e-3);  // the grid is shifted
}

TEST(Statistics, OfAFolderWithoutMeshes) {
  FragmentSet set;
  set.manifest = true;
  set.fragments.resize(8);
  for (std::size_t i = 0; i < 8; ++i) {
    set.fragments[i].mesh.id = static_cast<int>(i) + 1;
    set.fragments[i].share = 0.125;
    set.fragments[i].contacts = 3;
  }
  const FractureStatistics found = statistics(set, {.simulations = kFew});
  EXPECT_EQ(found.contacts->mean, 3.0);
  EXPECT_FALSE(found.faces || found.interiorFaces || found.orientation || found.corners);
  EXPECT_EQ(found.sizes.count, 8u);
  EXPECT_EQ(found.notes.size(), 1u);
}

TEST(Statistics, RefuseOptionsOutOfRange) {
  const FragmentSet set = setOf({shapes::cube(1.0)});
  const auto refused = [&](const StatisticsOptions& options) {
    try {
      (void)statistics(set, options);
    } catch (const Error& error) {
      return error.code() == ErrorCode::usage;
    }
    return false;
  };
  EXPECT_TRUE(refused({.unit = -1.0}));
  EXPECT_TRUE(refused({.unit = 1e300}));   // an area would be infinite
  EXPECT_TRUE(refused({.unit = 1e-300}));  // or 0
  EXPECT_TRUE(refused({.planeTolerance = 0.0}));
  EXPECT_TRUE(refused({.planeTolerance = 1e300}));
  EXPECT_TRUE(refused({.leastFace = 1e300}));
  EXPECT_TRUE(refused({.leastFace = std::nan("")}));
  EXPECT_TRUE(refused({.propagation = glm::dvec3(0.0)}));
  EXPECT_TRUE(refused({.simulations = 0}));
  EXPECT_TRUE(refused({.tolerance = 0.0}));
  EXPECT_FALSE(refused({.simulations = kFew}));
  for (const double unit : {1e-100, 1e100}) {
    const FractureStatistics found = statistics(set, {.unit = unit, .simulations = kFew});
    EXPECT_TRUE(std::isnormal(found.leastArea) && std::isnormal(found.planeTolerance));
  }
  EXPECT_THROW((void)statistics(FragmentSet{}), Error);
}

TEST(Statistics, StopWhenCancelled) {
  Progress progress;
  progress.cancelled = [] { return true; };
  try {
    (void)statistics(setOf(block()), {}, &progress);
    ADD_FAILURE() << "not stopped";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

// The eigenvalues of a matrix with known ones, and a plane's own triangles.
TEST(PlaneMoments, FindThePlaneOfATriangle) {
  const std::array<glm::dvec3, 3> triangle{{{1, 2, 3}, {2, 4, 3.5}, {0, 3, 7}}};
  PlaneMoments moments;
  moments.add(triangle);
  const FittedPlane plane = moments.plane();
  for (const glm::dvec3& corner : triangle) {
    EXPECT_NEAR(glm::dot(plane.normal, corner), plane.offset, 1e-9);
  }
  EXPECT_NEAR(moments.meanSquare(plane), 0.0, 1e-12);
  // Of a unit square about its middle: 1/12
  PlaneMoments square;
  square.add({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}});
  square.add({{{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}});
  EXPECT_NEAR(square.meanSquare({{1, 0, 0}, 0.5}), 1.0 / 12.0, 1e-12);
  const glm::dmat3 rotation{{0.36, 0.48, -0.8}, {-0.8, 0.6, 0.0}, {0.48, 0.64, 0.6}};
  const glm::dmat3 diagonal{{5, 0, 0}, {0, 3, 0}, {0, 0, -1}};
  const SymmetricEigen eigen = eigenOf(rotation * diagonal * glm::transpose(rotation));
  EXPECT_NEAR(eigen.values.x, 5.0, 1e-12);
  EXPECT_NEAR(eigen.values.y, 3.0, 1e-12);
  EXPECT_NEAR(eigen.values.z, -1.0, 1e-12);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::abs(glm::dot(eigen.vectors[static_cast<std::size_t>(i)], rotation[i])), 1.0,
                1e-12);
  }
}

// A diagonal with entries beside it from far below its rounding to far above, zeros and equal
// eigenvalues included: the vectors are an orthonormal basis that gives the matrix back.
TEST(SymmetricEigen, GivesTheMatrixBack) {
  constexpr std::array<double, 9> kBeside{0.0,   1e-18, -3e-17, 2e-16, -1e-15,
                                          6e-15, 1e-12, -1e-6,  0.2};
  for (const glm::dvec3& diagonal : {glm::dvec3(0, 0.5, 0.5),
                                     {0.5, 0, 0.5},
                                     {0.5, 0.5, 0},
                                     {1, 0, 0},
                                     {1, 1, 1},
                                     {0.2, 0.3, 0.5},
                                     {0, 0, 0}}) {
    for (const double xy : kBeside) {
      for (const double xz : kBeside) {
        for (const double yz : kBeside) {
          const glm::dmat3 matrix({diagonal.x, xy, xz}, {xy, diagonal.y, yz}, {xz, yz, diagonal.z});
          for (const SymmetricEigen& eigen : {eigenOf(matrix), fastEigenOf(matrix)}) {
            glm::dmat3 basis(eigen.vectors[0], eigen.vectors[1], eigen.vectors[2]), values(0.0);
            for (int i = 0; i < 3; ++i) values[i][i] = eigen.values[i];
            const glm::dmat3 back = basis * values * glm::transpose(basis);
            const glm::dmat3 unit = glm::transpose(basis) * basis;
            for (int i = 0; i < 3; ++i) {
              for (int k = 0; k < 3; ++k) {
                ASSERT_NEAR(back[i][k], matrix[i][k], 1e-12) << xy << ' ' << xz << ' ' << yz;
                ASSERT_NEAR(unit[i][k], i == k ? 1.0 : 0.0, 1e-12);
              }
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace sherd
