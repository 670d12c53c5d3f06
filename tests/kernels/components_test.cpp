// kernels/components.cl against a flood fill over a set of voxels.
#include <sherd/seeds.h>

#include <map>

#include "device_fixture.h"
#include "voxel_shapes.h"

namespace sherd {
namespace {

using openvdb::Coord;
using voxel_shapes::VoxelSolid;

// Connected components by flood fill, numbered by their first voxel in leaf order.
std::map<Coord, std::uint32_t> referenceComponents(const VoxelSolid& solid,
                                                   const LeafBlocks& blocks) {
  std::map<std::size_t, Coord> inLeafOrder;
  for (const Coord& v : solid.inside) inLeafOrder[voxel_shapes::voxelIndexOf(blocks, v)] = v;
  std::map<Coord, std::uint32_t> componentOf;
  std::uint32_t components = 0;
  for (const auto& [index, first] : inLeafOrder) {
    if (componentOf.count(first)) continue;
    std::vector<Coord> stack{first};
    componentOf[first] = components;
    while (!stack.empty()) {
      const Coord v = stack.back();
      stack.pop_back();
      for (const Coord& n : voxel_shapes::neighbors(v)) {
        if (solid.inside.count(n) && componentOf.try_emplace(n, components).second)
          stack.push_back(n);
      }
    }
    ++components;
  }
  return componentOf;
}

using ConnectedComponents = DeviceTest;

TEST_F(ConnectedComponents, EqualTheReferenceOnEveryShape) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    const std::map<Coord, std::uint32_t> reference = referenceComponents(solid, *blocks);
    std::vector<std::uint64_t> voxels;
    for (const auto& [voxel, component] : reference) {
      voxels.resize(std::max<std::size_t>(voxels.size(), component + 1));
      ++voxels[component];
    }
    const VoxelComponents components = findComponents(*blocks, device());
    EXPECT_EQ(components.voxels(), voxels) << solid.name;
    std::size_t wrong = 0;
    for (const auto& [voxel, component] : reference) {
      const std::size_t voxelIndex = voxel_shapes::voxelIndexOf(*blocks, voxel);
      wrong += components.at(voxelIndex) != component;
    }
    EXPECT_EQ(wrong, 0u) << solid.name;
  }
}

TEST_F(ConnectedComponents, EdgeAndCornerContactsDoNotJoin) {
  const VoxelSolid solid = voxel_shapes::checkerboard(9);
  const VoxelComponents components = findComponents(*voxel_shapes::blocksOf(solid), device());
  EXPECT_EQ(components.count(), solid.inside.size());
}

TEST_F(ConnectedComponents, ALongWindingPathIsOneComponent) {
  // A snake through many leaves, whose union-find chain is as long as it can be.
  const VoxelSolid snake = voxel_shapes::solidWhere(
      "snake", 30, [](const Coord& v) { return v.z() == 0 && v.y() % 4 == 0; });
  VoxelSolid joined = snake;
  for (int y = -28; y < 28; ++y) {
    if (y % 4 != 0) joined.inside.insert({((y + 28) / 4) % 2 ? -30 : 30, y, 0});
  }
  const VoxelComponents components = findComponents(*voxel_shapes::blocksOf(joined), device());
  EXPECT_EQ(components.count(), 1u);
  EXPECT_EQ(findComponents(*voxel_shapes::blocksOf(snake), device()).count(), 15u);
}

}  // namespace
}  // namespace sherd
