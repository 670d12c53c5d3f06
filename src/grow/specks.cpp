// Dropping specks.
#include "grow/specks.h"

#include <sherd/error.h>

#include <algorithm>
#include <string>

#include "voxelize/distance.h"

namespace sherd {

Solid dropSpecks(Solid solid, Parts& parts, Device& device) {
  const auto isSpeck = [&](std::uint32_t part) { return parts.voxels[part] < kSpeckVoxels; };
  for (std::uint32_t part = 0; part < parts.count(); ++part) {
    if (!isSpeck(part)) continue;
    ++solid.specks;
    solid.speckVoxels += parts.voxels[part];
  }
  if (solid.specks == 0) return solid;
  if (solid.specks == parts.count()) {
    throw Error(ErrorCode::input, "no part of the solid has " + std::to_string(kSpeckVoxels) +
                                      " voxels at this voxel size; try a higher --resolution");
  }
  solid.distance = withoutVoxels(*solid.distance, solid.blocks,
                                 [&](std::size_t place) { return isSpeck(parts.at(place)); });
  solid.blocks = leafBlocks(*solid.distance);
  measureVoxels(solid);
  parts = findParts(solid.blocks, device);
  return solid;
}

}  // namespace sherd
