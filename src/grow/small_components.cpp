// Removal of small components.
#include "grow/small_components.h"

#include <sherd/error.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "voxelize/distance.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {

Solid dropSmallComponents(Solid solid, VoxelComponents& components, Device& device) {
  const auto isSmallComponent = [&](std::uint32_t component) {
    return components.voxels()[component] < kSmallComponentVoxels;
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
