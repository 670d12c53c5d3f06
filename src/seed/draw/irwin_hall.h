// Approximately normal draws without logarithms and cosines, whose last bits differ between
// machines.
#pragma once

#include <cstdint>

#include "base/random.h"

namespace sherd {

/// Returns the mean of n uniforms minus 1/2: mean 0, variance 1 / (12 n), within (-1/2, 1/2).  Each
/// uniform has 32 bits; the draws are items item * n .. item * n + n - 1.
/// source  Irwin and Hall, 1927: with n = 12 the excess kurtosis is -0.1
inline double meanOfUniforms(std::uint64_t n, std::uint64_t seed, Stage stage, std::uint64_t item) {
  std::uint64_t sum = 0;
  for (std::uint64_t k = 0; k < n; ++k) sum += randomBits(seed, stage, item * n + k) >> 32;
  // Each uniform is the middle of its interval, so that the sum is symmetric.
  return static_cast<double>(2 * sum + n) / static_cast<double>(n << 33) - 0.5;
}

/// The default number of uniforms that approximate a normal draw.
inline constexpr int kNormalTerms = 12;

}  // namespace sherd
