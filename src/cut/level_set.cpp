// Cuts level sets.
#include "cut/level_set.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "voxelize/distance.h"

namespace sherd {
namespace {

using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;

// Adds the solid's leaf unchanged, or an inside tile where the solid has no leaf and is inside.
void addWhole(FloatGrid& grid, const FloatGrid& solid, const openvdb::Coord& origin) {
  if (const Leaf* leaf = solid.tree().probeConstLeaf(origin)) {
    grid.tree().addLeaf(new Leaf(*leaf));
  } else if (solid.tree().getValue(origin) < 0.0f) {
    grid.tree().addTile(1, origin, -grid.background(), false);
  }
}

}  // namespace

ConstFloatGridPtr fragmentLevelSet(const Solid& solid, const Cut& cut, std::uint16_t fragment,
                                   std::span<const std::uint32_t> leaves) {
  const FloatGridPtr grid = emptyLike(*solid.distance);
  grid->clearMetadata();
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("surface");
  const float band = grid->background();
  const auto voxelSize = static_cast<float>(solid.frame.voxelSize);
  for (const std::uint32_t at : leaves) {
    const openvdb::Coord& origin = solid.blocks->origins[at];
    if (cut.index[at] == Cut::kWhole) {
      addWhole(*grid, *solid.distance, origin);
      continue;
    }
    const Leaf* whole = solid.distance->tree().probeConstLeaf(origin);
    const float tile = std::copysign(band, solid.distance->tree().getValue(origin));
    const CutLeaf& cutLeaf = cut.leaves[cut.index[at]];
    const auto i = static_cast<std::size_t>(
        std::lower_bound(cutLeaf.fragments.begin(), cutLeaf.fragments.end(), fragment) -
        cutLeaf.fragments.begin());
    auto leaf = std::make_unique<Leaf>(origin, band, false);
    for (openvdb::Index v = 0; v < 512; ++v) {
      const float solidValue = whole ? whole->getValue(v) : tile;
      // A clamped distance becomes the background exactly: three times the voxel size may round to
      // less than that.
      const float voxels = cutLeaf.distance[i * 512 + v];
      const float toCut =
          std::abs(voxels) < kHalfWidthVoxels ? voxels * voxelSize : std::copysign(band, voxels);
      const float value = std::max(solidValue, toCut);
      if (value <= -band) {
        leaf->setValueOff(v, -band);
      } else if (value < band) {
        leaf->setValueOn(v, value);
      }
    }
    grid->tree().addLeaf(leaf.release());
  }
  openvdb::tools::pruneLevelSet(grid->tree(), /*threaded=*/false);
  return grid;
}

std::shared_ptr<FloatGrid> fogVolume(const FloatGrid& levelSet) {
  const FloatGridPtr fog = copyOf(levelSet);
  openvdb::tools::sdfToFogVolume(*fog);
  return fog;
}

}  // namespace sherd
