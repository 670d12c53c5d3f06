// Shares of a solid drawn from a distribution of sizes.
#include "seed/draw/sizes.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/random.h"
#include "seed/draw/samplers.h"

namespace sherd {
namespace {

// Logarithms and powers differ in their last bits between versions of the C library: 32 bits are
// kept.
double roundedSize(double x) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::floor(std::ldexp(mantissa, 32) + 0.5), exponent - 32);
}

// Returns the integral of x^power over 1..kPowerSpan.
double integralOfPower(double power) {
  if (std::abs(power + 1.0) < 1e-9) return std::log(kPowerSpan);
  return std::expm1((power + 1.0) * std::log(kPowerSpan)) / (power + 1.0);
}

// A size from the distribution's quantile function; a and b are uniform in [0, 1).
double sizeOf(Sizes sizes, double parameter, double a, double b) {
  switch (sizes) {
    case Sizes::lognormal: {  // Box and Muller, A Note on the Generation of Random Normal Deviates
      const double normal = std::sqrt(-2.0 * std::log1p(-a)) * std::cos(2.0 * std::numbers::pi * b);
      return std::exp(parameter * normal);
    }
    case Sizes::power: {
      const double flatness = 1.0 - parameter;
      if (std::abs(flatness) < 1e-9) return std::exp(a * std::log(kPowerSpan));
      return std::exp(std::log1p(a * flatness * integralOfPower(-parameter)) / flatness);
    }
    case Sizes::exponential:
      return -std::log1p(-a);
    case Sizes::grown:
    case Sizes::uniform:
      break;
  }
  return 1.0;
}

void check(Sizes sizes, double parameter, std::size_t pieces, double leastShare) {
  const auto need = [](bool good, const char* sentence) {
    if (!good) throw Error(ErrorCode::usage, sentence, OptionNames{"sizes"});
  };
  need(sizes != Sizes::grown, "shares are drawn from a distribution of sizes, and there is none");
  need(pieces >= 1, "shares are drawn for one piece or more");
  need(sizes != Sizes::lognormal || (parameter >= 0.01 && parameter <= 3.0),
       "the standard deviation of lognormal sizes must lie in 0.01..3");
  need(sizes != Sizes::power || (parameter >= 1.0 && parameter <= 4.0),
       "the exponent of sizes by a power law must lie in 1..4");
  need(leastShare >= 0.0 && leastShare * static_cast<double>(pieces) <= 1.0 + 1e-12,
       "the least share must lie between 0 and 1 by the number of pieces");
}

// Raises shares to the least, at the cost of the others in proportion to what they have above it.
void raise(std::vector<double>& shares, double leastShare) {
  double missing = 0.0, above = 0.0;
  for (const double share : shares) {
    missing += std::max(leastShare - share, 0.0);
    above += std::max(share - leastShare, 0.0);
  }
  const double kept = above > 0.0 ? std::max(1.0 - missing / above, 0.0) : 0.0;
  for (double& share : shares) share = leastShare + kept * std::max(share - leastShare, 0.0);
}

}  // namespace

double meanOfPower(double exponent) {
  return integralOfPower(1.0 - exponent) / integralOfPower(-exponent);
}

std::vector<double> drawnShares(Sizes sizes, double parameter, std::size_t pieces,
                                double leastShare, std::uint64_t seed) {
  check(sizes, parameter, pieces, leastShare);
  const auto draw = [&](std::size_t piece, std::uint64_t round) {
    const std::uint64_t item = 2 * drawItem(piece, round);
    return roundedSize(sizeOf(sizes, parameter, randomUnit(seed, Stage::pieceSize, item),
                              randomUnit(seed, Stage::pieceSize, item + 1)));
  };
  std::vector<double> drawn(pieces);
  for (std::size_t i = 0; i < pieces; ++i) drawn[i] = draw(i, 0);
  constexpr std::uint64_t kRounds = 64;
  double sum = std::accumulate(drawn.begin(), drawn.end(), 0.0);
  bool anySmall = leastShare > 0.0;
  for (std::uint64_t round = 1; round <= kRounds && anySmall; ++round) {
    anySmall = false;
    for (std::size_t i = 0; i < pieces; ++i) {
      if (drawn[i] >= leastShare * sum) continue;
      drawn[i] = draw(i, round);
      anySmall = true;
    }
    sum = std::accumulate(drawn.begin(), drawn.end(), 0.0);
  }
  if (!(sum > 0.0)) {  // one exponential draw of 0
    std::fill(drawn.begin(), drawn.end(), 1.0);
    sum = static_cast<double>(pieces);
  }
  for (double& share : drawn) share /= sum;
  if (anySmall) raise(drawn, leastShare);
  return drawn;
}

}  // namespace sherd
