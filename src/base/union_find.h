// Disjoint sets of the numbers 0..n-1.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace sherd {

/// Every number starts as a set of its own.  A set is named by its least number, so that names do
/// not depend on the order of unions.
///   source  Tarjan, van Leeuwen, Worst-case analysis of set union algorithms, 1984 (path halving)
class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  /// Returns the least number of a number's set.
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  /// Returns [n] find of each.
  [[nodiscard]] std::vector<std::uint32_t> all() && {
    for (std::uint32_t i = 0; i < parent_.size(); ++i) parent_[i] = find(i);
    return std::move(parent_);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace sherd
