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
  std::vector<cl_ushort> voxels(state.voxels());
  std::iota(voxels.begin(), voxels.end(), cl_ushort{0});
  std::vector<cl_uint> items;
  for (cl_uint item = state.items; item-- > 0;) {
    if (item % 3 != 1) items.push_back(item);
  }
  std::vector<cl_ushort> gathered, scattered(voxels.size(), 7);
  for (const std::size_t item : items) {
    for (std::size_t v = item * 512; v < (item + 1) * 512; ++v) {
      gathered.push_back(voxels[v]);
      scattered[v] = voxels[v];
    }
  }

  const auto count = static_cast<cl_uint>(items.size());
  const DeviceBuffer list = uploadBuffer<cl_uint>(impl, items);
  const DeviceBuffer blocksBuffer = makeBuffer<cl_ushort>(impl, gathered.size());
  state.run("gather_voxels", count, uploadBuffer<cl_ushort>(impl, voxels), list, count,
            blocksBuffer);
  EXPECT_EQ(downloaded<cl_ushort>(impl, blocksBuffer, gathered.size()), gathered);

  const DeviceBuffer target = state.filled<cl_ushort>(voxels.size(), 7);
  state.run("scatter_voxels", count, blocksBuffer, list, count, target);
  EXPECT_EQ(downloaded<cl_ushort>(impl, target, voxels.size()), scattered);
}

}  // namespace
}  // namespace sherd
