// gather.cl against plain copies, bit for bit.
#include <array>
#include <numeric>

#include "cl/device_impl.h"
#include "device_fixture.h"
#include "grow/fields/growth_state.h"
#include "voxel_shapes.h"

namespace sherd {
namespace {

using Gather = DeviceTest;
using voxel_shapes::VoxelSolid;

TEST_F(Gather, CopiesListedItemsOutAndBack) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::ball(12));
  DeviceImpl& impl = implOf(device());
  GrowthState state(*blocks, 1, impl);
  std::vector<std::uint16_t> voxels(state.voxels());
  std::iota(voxels.begin(), voxels.end(), std::uint16_t{0});
  std::vector<std::uint32_t> items;
  for (std::uint32_t item = state.items; item-- > 0;) {
    if (item % 3 != 1) items.push_back(item);
  }
  std::vector<std::uint16_t> gathered, scattered(voxels.size(), 7);
  for (const std::size_t item : items) {
    for (std::size_t v = item * 512; v < (item + 1) * 512; ++v) {
      gathered.push_back(voxels[v]);
      scattered[v] = voxels[v];
    }
  }

  const auto count = static_cast<std::uint32_t>(items.size());
  const DeviceBuffer list = uploadBuffer<std::uint32_t>(impl, items);
  const DeviceBuffer blocksBuffer = makeBuffer<std::uint16_t>(impl, gathered.size());
  state.run("gather_voxels", count, uploadBuffer<std::uint16_t>(impl, voxels), list, count,
            blocksBuffer);
  EXPECT_EQ(downloaded<std::uint16_t>(impl, blocksBuffer, gathered.size()), gathered);

  const DeviceBuffer target = state.filled<std::uint16_t>(voxels.size(), 7);
  state.run("scatter_voxels", count, blocksBuffer, list, count, target);
  EXPECT_EQ(downloaded<std::uint16_t>(impl, target, voxels.size()), scattered);
}

TEST_F(Gather, LabelsOfListedLeavesAreWrittenPerVoxel) {
  const VoxelSolid solid = voxel_shapes::ball(12);
  const auto blocks = voxel_shapes::blocksOf(solid);
  DeviceImpl& impl = implOf(device());
  GrowthState state(*blocks, 1, impl);
  constexpr std::uint16_t kBefore = 77;
  // No label, one, two (at even offsets the second), one per voxel.
  std::vector<std::uint32_t> tags(state.items), items;
  std::vector<std::uint64_t> second(3 * state.words(), ~std::uint64_t{0});
  for (std::uint32_t item = 0; item < state.items; ++item) {
    tags[item] = std::array<std::uint32_t, 4>{0, 5, 3 | 9u << 16, SHERD_TAG_MIXED}[item % 4];
    if (item % 5 != 2) items.push_back(item);
    for (std::size_t word = 0; word < 8; ++word) {
      const std::uint64_t inside = blocks->inside[item * 8 + word];
      second[item * 24 + word] = inside & 0x5555555555555555;
    }
  }
  std::vector<std::uint16_t> expected(state.voxels(), kBefore);
  for (const std::size_t item : items) {
    for (std::size_t v = item * 512; v < (item + 1) * 512; ++v) {
      const std::uint32_t tag = tags[item];
      if (tag == SHERD_TAG_MIXED) continue;
      const std::uint32_t label = tag >> 16 != 0 && v % 2 == 0 ? tag >> 16 : tag & 0xffff;
      expected[v] = static_cast<std::uint16_t>(blocks->isInside(v) ? label : 0);
    }
  }

  const DeviceBuffer owner = state.filled<std::uint16_t>(state.voxels(), kBefore);
  const DeviceBuffer tag = uploadBuffer<std::uint32_t>(impl, tags);
  const auto count = static_cast<std::uint32_t>(items.size());
  state.run("expand_labels", count, state.inside, state.leafCount,
            uploadBuffer<std::uint32_t>(impl, items), count, owner, tag,
            uploadBuffer<std::uint64_t>(impl, second));
  EXPECT_EQ(downloaded<std::uint16_t>(impl, owner, state.voxels()), expected);
  for (const std::uint32_t item : items) tags[item] = SHERD_TAG_MIXED;
  EXPECT_EQ(downloaded<std::uint32_t>(impl, tag, state.items), tags);
}

}  // namespace
}  // namespace sherd
