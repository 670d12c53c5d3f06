// Random access to labels.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <cstdint>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// Labels by voxel position.  Caches the last leaf, because successive voxels mostly share it.
class LabelReader {
 public:
  LabelReader(const LeafBlocks& blocks, const Labels& labels) : blocks_(blocks), labels_(labels) {}

  /// Returns the label of a voxel inside or in the exterior band; 0 elsewhere.
  std::uint16_t at(const openvdb::Coord& voxel) {
    return find(voxel) ? labels_.fragment[voxelIndexOf(voxel)] : std::uint16_t{0};
  }

  bool isInside(const openvdb::Coord& voxel) {
    return find(voxel) && blocks_.isInside(voxelIndexOf(voxel));
  }

 private:
  bool find(const openvdb::Coord& voxel) {
    const openvdb::Coord origin = voxel & ~7;
    if (origin != origin_) {
      origin_ = origin;
      leaf_ = findLeaf(blocks_, voxel);
    }
    return leaf_ != LeafBlocks::kNone;
  }
  std::size_t voxelIndexOf(const openvdb::Coord& voxel) const {
    return std::size_t{leaf_} * 512 + offsetFromCoord(voxel);
  }

  const LeafBlocks& blocks_;
  const Labels& labels_;
  openvdb::Coord origin_ = openvdb::Coord::max();
  std::uint32_t leaf_ = LeafBlocks::kNone;
};

}  // namespace sherd
