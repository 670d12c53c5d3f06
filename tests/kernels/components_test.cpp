// kernels/components.cl against a flood fill over a set of voxels.
#include <sherd/seeds.h>

#include <map>

#include "device_fixture.h"
#include "voxel_shapes.h"

namespace sherd {
namespace {

using openvdb::Coord;
using voxel_shapes::VoxelSolid;

// Parts by flood fill, numbered by their first voxel in leaf order.
std::map<Coord, std::uint32_t> referenceParts(const VoxelSolid& solid, const LeafBlocks& blocks) {
  std::map<std::size_t, Coord> inLeafOrder;
  for (const Coord& v : solid.inside) inLeafOrder[voxel_shapes::placeOf(blocks, v)] = v;
  std::map<Coord, std::uint32_t> partOf;
  std::uint32_t parts = 0;
  for (const auto& [place, first] : inLeafOrder) {
    if (partOf.count(first)) continue;
    std::vector<Coord> stack{first};
    partOf[first] = parts;
    while (!stack.empty()) {
      const Coord v = stack.back();
      stack.pop_back();
      for (const Coord& n : voxel_shapes::neighbours(v)) {
        if (solid.inside.count(n) && partOf.try_emplace(n, parts).second) stack.push_back(n);
      }
    }
    ++parts;
  }
  return partOf;
}

using Components = DeviceTest;

TEST_F(Components, EqualTheReferenceOnEveryShape) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const LeafBlocks blocks = voxel_shapes::blocksOf(solid);
    const std::map<Coord, std::uint32_t> reference = referenceParts(solid, blocks);
    std::vector<std::uint64_t> voxels;
    for (const auto& [voxel, part] : reference) {
      voxels.resize(std::max<std::size_t>(voxels.size(), part + 1));
      ++voxels[part];
    }
    const Parts parts = findParts(blocks, device());
    EXPECT_EQ(parts.voxels, voxels) << solid.name;
    std::size_t wrong = 0;
    for (const auto& [voxel, part] : reference) {
      const std::size_t place = voxel_shapes::placeOf(blocks, voxel);
      wrong += parts.at(place) != part;
    }
    EXPECT_EQ(wrong, 0u) << solid.name;
  }
}

TEST_F(Components, EdgeAndCornerContactsDoNotJoin) {
  const VoxelSolid solid = voxel_shapes::checkerboard(9);
  const Parts parts = findParts(voxel_shapes::blocksOf(solid), device());
  EXPECT_EQ(parts.count(), solid.inside.size());
}

TEST_F(Components, ALongWindingWayIsOnePart) {
  // A snake through many leaves, whose union-find chain is as long as it can be.
  const VoxelSolid snake = voxel_shapes::solidWhere(
      "snake", 30, [](const Coord& v) { return v.z() == 0 && v.y() % 4 == 0; });
  VoxelSolid joined = snake;
  for (int y = -28; y < 28; ++y) {
    if (y % 4 != 0) joined.inside.insert({((y + 28) / 4) % 2 ? -30 : 30, y, 0});
  }
  const Parts parts = findParts(voxel_shapes::blocksOf(joined), device());
  EXPECT_EQ(parts.count(), 1u);
  EXPECT_EQ(findParts(voxel_shapes::blocksOf(snake), device()).count(), 15u);
}

}  // namespace
}  // namespace sherd
