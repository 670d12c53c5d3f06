// Crossings of quads against those of all pairs of triangles.
#include "interface/cells/quad_crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/sort_unique.h"
#include "interface/cells/cell_set.h"
#include "intersect/self_crossings.h"
#include "mesh/search/boxes.h"

namespace sherd {
namespace {

// 3 x 3 x 3 leaves but one.
std::vector<openvdb::Coord> someLeaves() {
  std::vector<openvdb::Coord> origins;
  for (int k = 0; k < 27; ++k) {
    if (k != 5) origins.emplace_back(8 * (k / 9 - 1), 8 * (k / 3 % 3 - 1), 8 * (k % 3 - 1));
  }
  return origins;
}

class RandomQuads {
 public:
  explicit RandomQuads(std::span<const openvdb::Coord> origins) : quads(origins.size()) {
    for (std::size_t leaf = 0; leaf < origins.size(); ++leaf) {
      for (std::uint16_t offset = 0; offset < 512; ++offset) {
        if (random_() % 8 != 0) continue;
        const glm::dvec3 at(origins[leaf].x() + (offset >> 6),
                            origins[leaf].y() + ((offset >> 3) & 7),
                            origins[leaf].z() + (offset & 7));
        quads[leaf].push_back(quadAt(at, offset, static_cast<int>(random_() % 3)));
      }
    }
  }

  std::vector<glm::dvec3> vertices;
  std::vector<std::vector<QuadTriangles>> quads;

 private:
  // A quad around the edge from `at`; some have a vertex of the one before.
  QuadTriangles quadAt(const glm::dvec3& at, std::uint16_t offset, int axis) {
    std::uniform_real_distribution<double> inCell(-kMostOutside, 1.0 + kMostOutside);
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (int k = 0; k < 4; ++k) {
      glm::dvec3 p = at + glm::dvec3(inCell(random_), inCell(random_), inCell(random_));
      if (k == 0 || k == 3) p[(axis + 1) % 3] -= 1.0;
      if (k < 2) p[(axis + 2) % 3] -= 1.0;
      vertices.push_back(p);
    }
    const bool isShared =
        first > 0 && random_() % 4 == 0 && glm::distance(vertices[first - 1], at) < 1.0;
    const std::uint32_t corner = isShared ? first - 1 : first;
    QuadTriangles quad;
    quad.offset = offset;
    quad.triangle = {glm::uvec3(corner, first + 1, first + 2), {corner, first + 2, first + 3}};
    for (bool& is : quad.isTested) is = random_() % 2 == 0;
    return quad;
  }

  std::mt19937 random_{5};
};

TEST(QuadCrossings, AreThoseOfAllPairs) {
  const std::vector<openvdb::Coord> origins = someLeaves();
  const RandomQuads random(origins);
  std::vector<glm::uvec3> triangles;
  std::vector<std::uint8_t> isTested;
  for (const std::vector<QuadTriangles>& ofLeaf : random.quads) {
    for (const QuadTriangles& quad : ofLeaf) {
      triangles.insert(triangles.end(), quad.triangle.begin(), quad.triangle.end());
      for (const bool is : quad.isTested) isTested.push_back(is ? 1 : 0);
    }
  }
  std::vector<std::uint32_t> expected;
  for (const auto& pair : selfCrossings(random.vertices, triangles, nullptr, {.of = isTested})) {
    for (const std::uint32_t t : pair)
      expected.insert(expected.end(), {triangles[t].x, triangles[t].y, triangles[t].z});
  }
  std::vector<std::uint32_t> found =
      verticesOfCrossings(origins, leafNeighbors(origins), random.quads, random.vertices, nullptr);
  sortUnique(expected);
  sortUnique(found);
  EXPECT_GT(expected.size(), random.vertices.size() / 10);
  EXPECT_LT(expected.size(), random.vertices.size());
  EXPECT_EQ(found, expected);
}

TEST(CellSet, HasCellsByTheirDistanceAcrossLeaves) {
  const std::vector<openvdb::Coord> origins = someLeaves();
  const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(origins);
  const std::size_t middle = 12;
  ASSERT_EQ(origins[middle], openvdb::Coord(0, 0, 0));
  const openvdb::Coord from(1, 7, 4), other(6, 2, 2);
  const auto offset = [](const openvdb::Coord& at) {
    return static_cast<unsigned>(((at.x() & 7) << 6) + ((at.y() & 7) << 3) + (at.z() & 7));
  };
  CellSet around(origins.size()), common(origins.size());
  around.addAround(neighborhoods[middle], offset(from), 2);
  common.addAround(neighborhoods[middle], offset(other), 4);
  const CellSet grown = around.grown(neighborhoods);
  common.intersect(around);
  const auto apart = [](const openvdb::Coord& a, const openvdb::Coord& b) {
    const openvdb::Coord d = a - b;
    return std::max({std::abs(d.x()), std::abs(d.y()), std::abs(d.z())});
  };
  for (std::size_t leaf = 0; leaf < origins.size(); ++leaf) {
    for (int k = 0; k < 512; ++k) {
      const openvdb::Coord at = origins[leaf].offsetBy(k >> 6, (k >> 3) & 7, k & 7);
      ASSERT_EQ(around.has(leaf, offset(at)), apart(at, from) <= 2) << at;
      ASSERT_EQ(grown.has(leaf, offset(at)), apart(at, from) <= 3) << at;
      ASSERT_EQ(common.has(leaf, offset(at)), apart(at, from) <= 2 && apart(at, other) <= 4) << at;
    }
  }
}

}  // namespace
}  // namespace sherd
