// The tree of splits.
#pragma once

#include <sherd/labels.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace sherd {

/// For each split and each fragment the number of the split that it comes from, counted from 1; 0
/// where it is a component of the solid.
struct SplitParents {
  std::vector<std::size_t> ofSplit;     ///< [splits]
  std::vector<std::size_t> ofFragment;  ///< [fragments]

  /// Returns whether the first split divided the intact object; else its components are its parts.
  [[nodiscard]] bool hasWhole() const {
    return std::count(ofSplit.begin(), ofSplit.end(), 0u) == 1 &&
           std::count(ofFragment.begin(), ofFragment.end(), 0u) == 0;
  }
};

/// Returns the parents.
///   splits     a piece before those that come of it
///   fragments  their number, or less: those of splits are added
inline SplitParents parentsOf(std::span<const Split> splits, std::size_t fragments) {
  SplitParents parents;
  for (const Split& split : splits) {
    fragments = std::max<std::size_t>({fragments, split.fragment, split.added});
  }
  std::vector<std::size_t> last(fragments + 1, 0);
  for (const Split& split : splits) {
    parents.ofSplit.push_back(last[split.fragment]);
    last[split.fragment] = last[split.added] = parents.ofSplit.size();
  }
  parents.ofFragment.assign(last.begin() + 1, last.end());
  return parents;
}

}  // namespace sherd
