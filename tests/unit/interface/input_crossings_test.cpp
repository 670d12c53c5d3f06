// Crossings of a leaf's edges, found at once and one by one.
#include "interface/cells/input_crossings.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include "cut/intact_labels.h"
#include "interface/cells/cell_values.h"
#include "shapes.h"

namespace sherd {
namespace {

// Edges between inside and outside at the corners of a leaf's cells.
std::vector<CrossedEdge> crossedEdges(const Field& field, std::size_t leaf) {
  const LabelCube<9> corners = field.cornersOf(leaf);
  const auto isInside = [&](const openvdb::Coord& at) {
    return corners[static_cast<std::size_t>((at.x() * 9 + at.y()) * 9 + at.z())] != 0;
  };
  std::vector<CrossedEdge> edges;
  for (int i = 0; i < 9 * 9 * 9; ++i) {
    const openvdb::Coord low(i / 81, i / 9 % 9, i % 9);
    for (std::uint8_t axis = 0; axis < 3; ++axis) {
      openvdb::Coord high = low;
      if (++high[axis] < 9 && isInside(low) != isInside(high))
        edges.push_back({low, axis, isInside(low)});
    }
  }
  return edges;
}

// Of triangles larger and smaller than a voxel, and of few large ones, whose boxes meet many edges.
TEST(InputCrossings, AreTheSameFoundAtOnce) {
  for (const TriangleMesh& mesh :
       {shapes::ball(1.0, 5), shapes::ball(1.0, 3), shapes::cup(1.0, 0.25, 1.5, 0.25, 400)}) {
    const Solid solid = voxelize(mesh, {.resolution = 48});
    const IntactLabels intact(solid.blocks);
    const auto neighborhoods = leafNeighbors(solid.blocks->origins);
    const Field field(solid, intact.labels, intact.cut, neighborhoods, nullptr);
    std::size_t crossings = 0;
    for (std::size_t leaf = 0; leaf < solid.blocks->count(); ++leaf) {
      const std::vector<CrossedEdge> edges = crossedEdges(field, leaf);
      InputCrossings atOnce(solid, solid.blocks->origins[leaf]),
          oneByOne(solid, solid.blocks->origins[leaf]);
      atOnce.find(edges);
      for (const CrossedEdge& edge : edges) {
        const std::optional<InputCrossing>&found = atOnce.on(edge), &expected = oneByOne.on(edge);
        ASSERT_EQ(found.has_value(), expected.has_value());
        if (!found) continue;
        ++crossings;
        EXPECT_EQ(found->at, expected->at);
        EXPECT_EQ(found->normal, expected->normal);
        EXPECT_EQ(found->triangle, expected->triangle);
      }
    }
    EXPECT_GT(crossings, 5000u);
  }
}

TEST(Distances, OfALeafAreThoseOfTheGrid) {
  const Solid solid = voxelize(shapes::ball(1.0, 3), {.resolution = 24});
  const IntactLabels intact(solid.blocks);
  const auto neighborhoods = leafNeighbors(solid.blocks->origins);
  const Field field(solid, intact.labels, intact.cut, neighborhoods, nullptr);
  for (std::size_t leaf = 0; leaf < solid.blocks->count(); ++leaf) {
    const DistanceCube cube = distancesOf(field, leaf);
    for (int i = 0; i < 9 * 9 * 9; ++i) {
      const openvdb::Coord at = solid.blocks->origins[leaf].offsetBy(i / 81, i / 9 % 9, i % 9);
      ASSERT_EQ(cube[static_cast<std::size_t>(i)], solid.distance->tree().getValue(at)) << at;
    }
  }
}

}  // namespace
}  // namespace sherd
