// Consecutive numbers of some vertices of a larger set.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace sherd {

/// Numbers the distinct ones of some vertices in ascending order.  By bits where they are many of
/// all vertices, else by sorting, so that neither many nor few of them cost more than their number
/// or a 64th of all.
class VertexNumbers {
 public:
  ///   used   with repetitions
  ///   count  of all vertices
  VertexNumbers(std::vector<std::uint32_t> used, std::size_t count) {
    if (used.size() < count / 64) {
      std::sort(used.begin(), used.end());
      used.erase(std::unique(used.begin(), used.end()), used.end());
      vertices_ = std::move(used);
      return;
    }
    bits_.resize(count / 64 + 1);
    for (const std::uint32_t v : used) bits_[v / 64] |= std::uint64_t{1} << (v % 64);
    first_.reserve(bits_.size());
    for (std::size_t word = 0; word < bits_.size(); ++word) {
      first_.push_back(static_cast<std::uint32_t>(vertices_.size()));
      for (std::uint64_t bits = bits_[word]; bits != 0; bits &= bits - 1) {
        vertices_.push_back(
            static_cast<std::uint32_t>(word * 64 + static_cast<unsigned>(std::countr_zero(bits))));
      }
    }
  }

  /// Returns the distinct vertices, ascending.
  [[nodiscard]] std::span<const std::uint32_t> vertices() const { return vertices_; }

  /// Returns the number of a vertex that is used.
  [[nodiscard]] std::uint32_t of(std::uint32_t v) const {
    if (bits_.empty()) {
      return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), vertices_.end(), v) -
                                        vertices_.begin());
    }
    const std::uint64_t below = bits_[v / 64] & ((std::uint64_t{1} << (v % 64)) - 1);
    return first_[v / 64] + static_cast<std::uint32_t>(std::popcount(below));
  }

 private:
  std::vector<std::uint32_t> vertices_;
  std::vector<std::uint64_t> bits_;   // [count / 64 + 1], or empty
  std::vector<std::uint32_t> first_;  // [words] vertices before
};

}  // namespace sherd
