// Checks of labels that a caller made or kept.
#pragma once

#include <sherd/error.h>
#include <sherd/labels.h>
#include <sherd/solid.h>

#include <cstdint>
#include <string>
#include <vector>

namespace sherd {

/// Checks that labels have leaf blocks, and a label for each voxel of them.
///   throws  Error(usage)
inline void checkLabels(const Labels& labels) {
  if (!labels.blocks) throw Error(ErrorCode::usage, "the labels have no leaf blocks");
  if (labels.fragment.size() == labels.blocks->count() * 512) return;
  throw Error(ErrorCode::usage, "there are " + std::to_string(labels.fragment.size()) +
                                    " labels for " + std::to_string(labels.blocks->count()) +
                                    " leaves of 512 voxels");
}

/// Also checks that they are of this solid's blocks.
///   throws  Error(usage)
inline void checkLabels(const Labels& labels, const Solid& solid) {
  checkLabels(labels);
  if (labels.blocks == solid.blocks) return;
  throw Error(ErrorCode::usage, "the labels are of other leaf blocks than the solid's");
}

/// Also checks that each inside voxel has a label.
///   return  [fragmentCount + 1] the voxels of each fragment
///   throws  Error(usage)
[[nodiscard]] inline std::vector<std::uint64_t> checkedCounts(const Labels& labels,
                                                              const Solid& solid) {
  checkLabels(labels, solid);
  std::vector<std::uint64_t> voxels = countVoxels(labels);
  if (voxels[0] == 0) return voxels;
  throw Error(ErrorCode::usage,
              std::to_string(voxels[0]) + " voxels of the solid have no fragment");
}

}  // namespace sherd
