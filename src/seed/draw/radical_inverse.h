// Halton's sequence in one base.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "base/random.h"

namespace sherd {

/// Halton's sequence in one base, in integers: the digits of the index mirrored at the radix point,
/// with an independent random permutation for each digit position.  This keeps one point in each
/// interval of length base^-k among base^k successive ones, and gives far more sequences than the
/// 1,440 of one permutation per base.
/// source  Matousek, On the L2-discrepancy for anchored boxes, 1998 (random digit scrambling)
class RadicalInverse {
 public:
  ///   base    2, 3 or 5
  ///   digits  at most 63; base^digits < 2^53
  RadicalInverse(std::uint64_t base, std::size_t digits, std::uint64_t seed, Stage stage)
      : base_(base), permuted_(digits) {
    for (std::size_t position = 0; position < digits; ++position) {
      std::array<std::uint8_t, 5>& digit = permuted_[position];
      std::iota(digit.begin(), digit.end(), std::uint8_t{0});
      for (std::uint64_t i = base; i > 1; --i) {
        const std::uint64_t item = (base * 64 + position) * 8 + i;
        std::swap(digit[i - 1], digit[randomBelow(i, seed, stage, item)]);
      }
      denominator_ *= base;
    }
  }

  /// Returns floor(count * at(index)), computed exactly; count * base^digits < 2^64.
  std::uint64_t below(std::uint64_t count, std::uint64_t index) const {
    return numerator(index) * count / denominator_;
  }

  /// Returns the number in [0, 1) at this index.
  double at(std::uint64_t index) const {
    return static_cast<double>(numerator(index)) / static_cast<double>(denominator_);
  }

 private:
  std::uint64_t numerator(std::uint64_t index) const {
    std::uint64_t numerator = 0;
    for (const std::array<std::uint8_t, 5>& digit : permuted_) {
      numerator = numerator * base_ + digit[index % base_];
      index /= base_;
    }
    return numerator;
  }

  std::uint64_t base_, denominator_ = 1;
  std::vector<std::array<std::uint8_t, 5>> permuted_;  // [position], the lowest digit first
};

}  // namespace sherd
