// Values of voxels that go on to others.
#include "voxelize/leaves/spread.h"

#include <utility>

#include "base/cancel_flag.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

std::vector<std::size_t> spread(const LeafBlocks& blocks, std::vector<std::size_t> open,
                                std::vector<std::uint16_t>& values, const Progress* progress,
                                SpreadFrom from) {
  const auto valueBeside = [&](std::size_t voxel) {
    for (std::size_t side = 0; side < 6; ++side) {
      const std::size_t beside = voxelBeside(blocks, voxel, side);
      if (beside == kNoVoxel || values[beside] == 0) continue;
      if (from == SpreadFrom::all || blocks.isInside(beside)) return values[beside];
    }
    return std::uint16_t{0};
  };
  while (!open.empty()) {
    throwIfCancelled(progress);
    std::vector<std::pair<std::size_t, std::uint16_t>> found;
    std::erase_if(open, [&](std::size_t voxel) {
      const std::uint16_t value = valueBeside(voxel);
      if (value != 0) found.emplace_back(voxel, value);
      return value != 0;
    });
    if (found.empty()) break;
    for (const auto& [voxel, value] : found) values[voxel] = value;
  }
  return open;
}

}  // namespace sherd
