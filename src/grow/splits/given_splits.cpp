// Cracks move from the voxels of one solid to those of another of the same mesh.
#include "grow/splits/given_splits.h"

#include <algorithm>
#include <cmath>

namespace sherd {
namespace {

// Returns a number of steps of 1/64 voxel or their multiples, rounded down.
std::int64_t steps(double value) { return static_cast<std::int64_t>(std::floor(value)); }

// A crack in other voxels.  With p' = r p + (r - 1) / 2 for positions, the plane n p = d becomes
// n p' = r d + n (r - 1) / 2, and spheres have r times their radius.
Split movedSplit(Split split, const VoxelScale& scale) {
  const double r = scale.ratio;
  if (split.isSphere) {
    constexpr double kMost = 0x1p60;  // squares that an integer still holds
    const glm::dvec3 center = 64.0 * scale.position(glm::dvec3(split.center) / 64.0);
    split.center = glm::ivec3(glm::floor(center + 0.5));
    split.offset = steps(std::min(static_cast<double>(split.offset) * r * r, kMost));
  } else if (split.normal != glm::ivec3(0)) {
    const double sum = split.normal.x + split.normal.y + split.normal.z;
    split.offset = steps(static_cast<double>(split.offset) * r + 32.0 * sum * (r - 1.0));
  }
  return split;
}

}  // namespace

GivenSplits givenFor(const GivenSplits& decided, const VoxelScale& scale,
                     std::span<const std::uint32_t> component) {
  std::vector<std::size_t> first;  // share of each root
  std::size_t all = 0;
  for (const GivenSplits::Root& root : decided.roots) {
    first.push_back(all);
    all += root.fragments;
  }
  GivenSplits given{.leastVoxels = decided.leastVoxels};
  for (const std::uint32_t from : component) {
    const GivenSplits::Root& root = decided.roots[from];
    given.roots.push_back(root);
    const auto begin = decided.shares.begin() + static_cast<std::ptrdiff_t>(first[from]);
    given.shares.insert(given.shares.end(), begin,
                        begin + static_cast<std::ptrdiff_t>(root.fragments));
  }
  for (const GivenSplit& each : decided.splits) {
    given.splits.push_back({movedSplit(each.split, scale), each.kept});
  }
  return given;
}

GivenOrder::GivenOrder(const GivenSplits& splits)
    : splits_(&splits), ofPiece_(splits.shares.size() + 1), at_(splits.shares.size() + 1, 0) {
  for (std::size_t i = 0; i < splits.splits.size(); ++i) {
    ofPiece_[splits.splits[i].split.fragment].push_back(i);
  }
}

const GivenSplit* GivenOrder::next(std::uint16_t id) const {
  if (splits_ == nullptr || at_[id] >= ofPiece_[id].size()) return nullptr;
  return &splits_->splits[ofPiece_[id][at_[id]]];
}

std::vector<std::uint16_t> GivenOrder::dropped(std::uint16_t id) {
  std::vector<std::uint16_t> ids, pieces{id};
  while (!pieces.empty()) {
    const std::uint16_t piece = pieces.back();
    pieces.pop_back();
    for (; const GivenSplit* const split = next(piece); advance(piece)) {
      ids.push_back(split->split.added);
      pieces.push_back(split->split.added);
    }
  }
  return ids;
}

}  // namespace sherd
