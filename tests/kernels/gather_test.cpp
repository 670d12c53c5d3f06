// gather.cl against plain copies, bit for bit.
#include <numeric>

#include "cl/device_impl.h"
#include "device_fixture.h"
#include "grow/growth_state.h"
#include "voxel_shapes.h"

namespace sherd {
namespace {

using Gather = DeviceTest;

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

}  // namespace
}  // namespace sherd
