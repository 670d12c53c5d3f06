// Dropping specks.
#include "voxelize/specks.h"

#include <sherd/error.h>

#include <algorithm>
#include <bit>
#include <string>

#include "voxelize/distance.h"

namespace sherd {

void measureVoxels(Solid& solid) {
  solid.voxels = solid.blocks.insideVoxels();
  solid.box = {openvdb::Coord::max(), openvdb::Coord::min()};
  for (std::size_t word = 0; word < solid.blocks.inside.size(); ++word) {
    const std::uint64_t bits = solid.blocks.inside[word];
    if (!bits) continue;
    std::uint64_t zs = bits;  // any y, folded into the low byte
    for (int shift = 32; shift >= 8; shift /= 2) zs |= zs >> shift;
    const auto z = static_cast<unsigned>(zs & 0xff);
    const openvdb::Coord origin =
        solid.blocks.origins[word / 8] + openvdb::Coord(static_cast<int>(word % 8), 0, 0);
    solid.box.min.minComponent(origin +
                               openvdb::Coord(0, std::countr_zero(bits) / 8, std::countr_zero(z)));
    solid.box.max.maxComponent(
        origin + openvdb::Coord(0, 7 - std::countl_zero(bits) / 8, 31 - std::countl_zero(z)));
  }
}

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
