// Labels and distances by voxel, over leaf blocks.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <algorithm>
#include <cstdint>
#include <span>

#include "cut/cut.h"
#include "cut/leaf_labels.h"
#include "interface/cells/cell.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

class Creases;

/// Labels and distances by voxel, over leaf blocks.
class Field {
 public:
  ///   neighborhoods  of the solid's leaves
  ///   creases        of the solid, or null: vertices are placed by the distances alone
  Field(const Solid& solid, const Labels& labels, const Cut& cut,
        std::span<const LeafNeighbors> neighborhoods, const Creases* creases)
      : solid_(solid),
        labels_(labels),
        cut_(cut),
        neighborhoods_(neighborhoods),
        creases_(creases) {}

  /// Returns the index of the voxel at x, y, z from a leaf's lowest voxel, in that leaf or one of
  /// its 26 neighbors; kNoVoxel if there is no leaf.
  static constexpr std::size_t kNoVoxel = ~std::size_t{0};
  std::size_t voxelIndexNear(std::size_t leaf, int x, int y, int z) const {
    const auto k = static_cast<std::size_t>(((x >> 3) + 1) * 9 + ((y >> 3) + 1) * 3 + (z >> 3) + 1);
    const std::uint32_t other = neighborhoods_[leaf][k];
    return other == LeafBlocks::kNone ? kNoVoxel
                                      : std::size_t{other} * 512 + offsetFromCoord({x, y, z});
  }

  std::uint16_t label(std::size_t voxelIndex) const {
    return voxelIndex != kNoVoxel && solid_.blocks->isInside(voxelIndex)
               ? labels_.fragment[voxelIndex]
               : std::uint16_t{0};
  }

  /// Returns the labels at all corners of a leaf's cells.
  LabelCube<9> cornersOf(std::size_t leaf) const {
    return labelsAround<0, 1>(*solid_.blocks, labels_, neighborhoods_[leaf], Voxels::inside);
  }

  CellLabels labelsOf(std::size_t leaf, int x, int y, int z) const {
    CellLabels labels;
    for (int corner = 0; corner < 8; ++corner) {
      labels[static_cast<std::size_t>(corner)] =
          label(voxelIndexNear(leaf, x + (corner >> 2), y + ((corner >> 1) & 1), z + (corner & 1)));
    }
    return labels;
  }

  /// Distances to the cut of one label in one leaf, in voxels, negative inside its fragment.
  struct ToCut {
    const float* distance = nullptr;  ///< [512], or null where all are `everywhere`
    float everywhere = kHalfWidthVoxels;

    float at(std::size_t offset) const { return distance ? distance[offset] : everywhere; }
  };
  ToCut toCut(std::size_t leaf, std::uint16_t label) const {
    if (cut_.index[leaf] == Cut::kWhole) {
      return {nullptr, (cut_.only[leaf] == label ? -1.0f : 1.0f) * float{kHalfWidthVoxels}};
    }
    const CutLeaf& cells = cut_.leaves[cut_.index[leaf]];
    const auto at = std::lower_bound(cells.fragments.begin(), cells.fragments.end(), label);
    if (at == cells.fragments.end() || *at != label) return {};
    return {&cells.distance[static_cast<std::size_t>(at - cells.fragments.begin()) * 512]};
  }

  const Solid& solid() const { return solid_; }
  const Cut& cut() const { return cut_; }
  const Creases* creases() const { return creases_; }

 private:
  const Solid& solid_;
  const Labels& labels_;
  const Cut& cut_;
  std::span<const LeafNeighbors> neighborhoods_;
  const Creases* creases_;
};

}  // namespace sherd
