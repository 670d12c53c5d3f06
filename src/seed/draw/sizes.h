// Shares of a solid drawn from a distribution of sizes.
#pragma once

#include <sherd/seeds.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sherd {

/// The greatest size of the power law, by the least.
inline constexpr double kPowerSpan = 1000.0;

/// Returns the mean of the power law over its least size: from 1 to kPowerSpan the density falls as
/// x^-exponent.  So shares of n pieces lie between 1 / (n mean) and kPowerSpan / (n mean), as far
/// as their sum is that of the mean.
[[nodiscard]] double meanOfPower(double exponent);

/// Draws the shares of a solid's pieces: independent sizes, divided by their sum.
///   parameter   of lognormal, 0.01..3: the standard deviation of the logarithm; of power, 1..4:
///   the
///               exponent.  Others have none
///   pieces      1 or more
///   leastShare  a share below it is drawn again.  Where 64 rounds of draws leave shares below it,
///               as when it is near 1 / pieces, these are raised to it and the others lowered
///   return      [pieces] with the sum 1, each at least leastShare; in no order
///   throws      Error(usage) the parameter is out of range; leastShare * pieces is above 1;
///               Sizes::grown
[[nodiscard]] std::vector<double> drawnShares(Sizes sizes, double parameter, std::size_t pieces,
                                              double leastShare, std::uint64_t seed);

}  // namespace sherd
