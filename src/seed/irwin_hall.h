// Normal draws without logarithms and cosines, whose last bits differ between machines.
#pragma once

#include <cstdint>

#include "base/random.h"

namespace sherd {

/// The mean of n uniforms, less a half: mean 0, variance 1 / (12 n), within (-1/2, 1/2).  Each
/// uniform has 32 bits; the draws are items item * n .. item * n + n - 1.
/// source  Irwin and Hall, 1927: with n = 12, half the excess kurtosis of a normal is 0.05
inline double meanOfUniforms(std::uint64_t n, std::uint64_t seed, Stage stage, std::uint64_t item) {
  std::uint64_t sum = 0;
  for (std::uint64_t k = 0; k < n; ++k) sum += randomBits(seed, stage, item * n + k) >> 32;
  // Each uniform stands for the middle of its interval, so that the sum is symmetric.
  return static_cast<double>(2 * sum + n) / static_cast<double>(n << 33) - 0.5;
}

/// How many uniforms stand for a normal draw where nothing else is asked.
inline constexpr int kNormalTerms = 12;

}  // namespace sherd
