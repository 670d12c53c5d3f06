// Level sets of several solids as one grid.
#include "dataset/assemblage/compose_grid.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <memory>

namespace sherd {

ConstFloatGridPtr composedGrid(std::span<const PlacedGrid> grids, const ConstFloatGridPtr& like) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
  const auto all = openvdb::FloatGrid::create(grids.front().grid->background());
  all->setGridClass(openvdb::GRID_LEVEL_SET);
  all->setName("surface");
  all->setTransform(like->transform().copy());
  for (const PlacedGrid& own : grids) {
    for (auto leaf = own.grid->tree().cbeginLeaf(); leaf; ++leaf) {
      auto copy = std::make_unique<Leaf>(*leaf);
      copy->setOrigin(leaf->origin() + openvdb::Coord(own.shift, 0, 0));
      all->tree().addLeaf(copy.release());
    }
  }
  openvdb::tools::signedFloodFill(all->tree());
  return all;
}

}  // namespace sherd
