// Removal of small components.
#include "grow/fields/small_components.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

std::uint64_t leastComponentVoxels(const Solid& solid) {
  const auto voxels = static_cast<double>(solid.voxels + solid.smallComponentVoxels);
  return std::max(kSmallComponentVoxels,
                  static_cast<std::uint64_t>(std::ceil(kSmallComponentShare * voxels)));
}

Solid dropSmallComponents(Solid solid, VoxelComponents& components, Device& device) {
  const std::uint64_t least = leastComponentVoxels(solid);
  const auto isSmallComponent = [&](std::uint32_t component) {
    return components.voxels()[component] < least;
  };
  for (std::uint32_t component = 0; component < components.count(); ++component) {
    if (!isSmallComponent(component)) continue;
    ++solid.smallComponents;
    solid.smallComponentVoxels += components.voxels()[component];
  }
  if (solid.smallComponents == 0) return solid;
  if (solid.smallComponents == components.count()) {
    throw Error(ErrorCode::input,
                "no component of the solid has " + std::to_string(kSmallComponentVoxels) +
                    " voxels at this voxel size; try a higher resolution",
                OptionNames{"resolution"});
  }
  solid.distance = withoutVoxels(*solid.distance, *solid.blocks, [&](std::size_t voxelIndex) {
    return isSmallComponent(components.at(voxelIndex));
  });
  LeafBlocks blocks = leafBlocks(*solid.distance);
  blocks.layers = layersOf(blocks, *solid.blocks);
  solid.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  measureVoxels(solid);
  components = findComponents(*solid.blocks, device);
  return solid;
}

}  // namespace sherd
