// Levels of the tree of splits.
#include "folder/files/split_levels.h"

#include <algorithm>
#include <map>
#include <utility>

namespace sherd {

SplitLevels::SplitLevels(SplitParents parents)
    : parents_(std::move(parents)), depth_(parents_.ofSplit.size() + 1, 0) {
  const std::size_t first = parents_.hasWhole() ? 2 : 1;  // below the intact object
  for (std::size_t split = first; split < depth_.size(); ++split) {
    depth_[split] = std::min(depth_[parents_.ofSplit[split - 1]] + 1, kDeepestLevel);
  }
}

std::size_t SplitLevels::ofContact(int one, int other) const {
  std::size_t a = splitOf(one), b = splitOf(other);
  while (a != b) {  // a split's number is above that of the one that it comes from
    std::size_t& later = a > b ? a : b;
    later = parents_.ofSplit[later - 1];
  }
  return std::min(depth_[a] + 1, kDeepestLevel);
}

std::vector<UnrealCluster> unrealClusters(const SplitLevels& levels,
                                          std::span<const Fragment> fragments) {
  std::map<std::size_t, int> levelOf;  // by depth
  for (const Fragment& fragment : fragments) levelOf[levels.ofFragment(fragment.id)];
  levelOf[0] = 1;
  int next = 1;
  for (auto& [depth, level] : levelOf) level = next++;
  std::vector<UnrealCluster> clusters;
  for (const Fragment& fragment : fragments) {
    const std::size_t depth = levels.ofFragment(fragment.id);
    const int split = depth == 0 ? -1 : static_cast<int>(levels.splitOf(fragment.id));
    clusters.push_back({levelOf[depth], split});
  }
  return clusters;
}

}  // namespace sherd
