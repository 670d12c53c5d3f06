// The voxels of each fragment as leaf masks.
#include "erode/masks.h"

#include <sherd/error.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

struct Group {
  std::uint16_t label = 0;
  LeafMask mask{};
};

// Returns the inside voxels of a leaf by label, ascending.  Sorts instead of searching, because a
// leaf may have hundreds of labels.
std::vector<Group> groupsOf(std::span<const std::uint64_t, 8> inside,
                            std::span<const std::uint16_t, 512> labels) {
  std::array<std::uint32_t, 512> keys;
  std::size_t count = 0;
  for (std::size_t x = 0; x < 8; ++x) {
    for (std::uint64_t bits = inside[x]; bits; bits &= bits - 1) {
      const auto at =
          static_cast<std::uint32_t>(x * 64) + static_cast<std::uint32_t>(std::countr_zero(bits));
      keys[count++] = std::uint32_t{labels[at]} << 16 | at;
    }
  }
  const auto end = keys.begin() + static_cast<std::ptrdiff_t>(count);
  if (!std::is_sorted(keys.begin(), end)) std::sort(keys.begin(), end);
  std::vector<Group> groups;
  for (std::size_t i = 0; i < count; ++i) {
    const auto label = static_cast<std::uint16_t>(keys[i] >> 16);
    if (groups.empty() || groups.back().label != label) groups.push_back({label, {}});
    groups.back().mask[(keys[i] >> 6) & 7] |= std::uint64_t{1} << (keys[i] & 63);
  }
  return groups;
}

void checkLabel(std::uint16_t label, int fragments) {
  if (label <= fragments || label == Labels::kEroded) return;
  throw Error(ErrorCode::usage, "erode: a voxel has label " + std::to_string(label) +
                                    "; expected 0 to " + std::to_string(fragments));
}

std::size_t layerOf(const LeafBlocks& blocks, std::size_t leaf, const LeafMask& mask) {
  std::size_t x = 0;
  while (mask[x] == 0) ++x;
  return blocks.layerOf(leaf * 512 + x * 64 + static_cast<std::size_t>(std::countr_zero(mask[x])));
}

}  // namespace

std::vector<FragmentMasks> fragmentMasks(const Labels& labels) {
  const LeafBlocks& blocks = *labels.blocks;
  std::vector<std::vector<Group>> groups(blocks.count());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups.size(), 64), [&](const auto& range) {
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      groups[leaf] =
          groupsOf(std::span<const std::uint64_t, 8>(&blocks.inside[leaf * 8], 8),
                   std::span<const std::uint16_t, 512>(&labels.fragment[leaf * 512], 512));
    }
  });
  std::vector<FragmentMasks> all(static_cast<std::size_t>(labels.fragmentCount));
  for (std::size_t leaf = 0; leaf < groups.size(); ++leaf) {
    for (const Group& group : groups[leaf]) {
      checkLabel(group.label, labels.fragmentCount);
      if (group.label == 0 || group.label == Labels::kEroded) continue;
      FragmentMasks& fragment = all[group.label - std::size_t{1}];
      if (fragment.leaf.empty()) fragment.layer = layerOf(blocks, leaf, group.mask);
      fragment.leaf.push_back(static_cast<std::uint32_t>(leaf));
      fragment.origins.push_back(blocks.origins[leaf]);
      fragment.masks.push_back(group.mask);
    }
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, all.size()), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      all[i].neighbors = leafNeighbors(all[i].origins);
    }
  });
  return all;
}

}  // namespace sherd
