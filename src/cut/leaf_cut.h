// The cut of one leaf.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cut/leaf_labels.h"

namespace sherd {

constexpr int kCutHalo = 2;  ///< voxels around a leaf that its cut depends on
constexpr int kCutSide = 8 + 2 * kCutHalo;

/// Labels of a leaf and of the voxels around it, z fastest.
using CutHalo = LabelCube<kCutSide>;

/// A bit for each voxel of a leaf: [x*8+y] bit z.
using VoxelBits = std::array<std::uint8_t, 64>;

/// The cut of a leaf where its labels are those of the nearest sites.
struct SiteCut {
  VoxelBits holds{};  ///< of the requested voxels: all inside voxels up to two away belong to
                      ///< their nearest site, so the distances are valid
  std::vector<float> distance;  ///< [fragments*512] voxels to the plane, within -3..3; 3 where not
                                ///< requested
};

}  // namespace sherd
