// Shares drawn from distributions of sizes, against estimators of their parameters.
#include "seed/draw/sizes.h"

#include <gtest/gtest.h>
#include <sherd/error.h>

#include <cmath>
#include <numeric>

#include "size_estimators.h"

namespace sherd {
namespace {

double sumOf(const std::vector<double>& shares) {
  return std::accumulate(shares.begin(), shares.end(), 0.0);
}

TEST(DrawnShares, SumToOneAndReachTheLeast) {
  for (const Sizes sizes : {Sizes::uniform, Sizes::lognormal, Sizes::power, Sizes::exponential}) {
    for (const std::size_t pieces : {1u, 2u, 7u, 500u}) {
      for (const double part : {0.0, 0.1, 0.5, 0.99, 1.0}) {
        const double least = part / static_cast<double>(pieces);
        const std::vector<double> shares = drawnShares(sizes, 1.5, pieces, least, 3);
        ASSERT_EQ(shares.size(), pieces);
        EXPECT_NEAR(sumOf(shares), 1.0, 1e-9);
        for (const double share : shares) ASSERT_GE(share, least);
      }
    }
  }
}

TEST(DrawnShares, DependOnTheSeedAlone) {
  const auto shares = drawnShares(Sizes::exponential, 0.0, 50, 0.0, 3);
  EXPECT_EQ(drawnShares(Sizes::exponential, 0.0, 50, 0.0, 3), shares);
  EXPECT_NE(drawnShares(Sizes::exponential, 0.0, 50, 0.0, 4), shares);
}

// A standard error is passed fourfold once in 16,000 times.
TEST(DrawnShares, HaveTheParametersThatEstimatorsFind) {
  for (const std::size_t pieces : {500u, 20000u}) {
    for (const double s : {0.1, 0.8, 2.0}) {
      const auto found = estimators::lognormal(drawnShares(Sizes::lognormal, s, pieces, 0.0, 11));
      EXPECT_NEAR(found.value, s, 4.0 * found.standardError) << pieces;
    }
    for (const double tau : {1.0, 1.6, 2.5, 4.0}) {
      const auto found = estimators::power(drawnShares(Sizes::power, tau, pieces, 0.0, 11));
      EXPECT_NEAR(found.value, tau, 4.0 * found.standardError) << pieces;
      EXPECT_LT(found.standardError, pieces == 500 ? 0.2 : 0.03);
    }
  }
}

// The test refuses one set in 20 of what is exponential: of 200 sets 10 with a standard deviation
// of 3.1.
TEST(DrawnShares, AreExponentialByLillieforsTest) {
  int passed = 0, others = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    passed += estimators::isExponential(drawnShares(Sizes::exponential, 0.0, 500, 0.0, seed));
    others += estimators::isExponential(drawnShares(Sizes::lognormal, 0.8, 500, 0.0, seed));
  }
  EXPECT_GE(passed, 200 - 10 - 13);
  EXPECT_LT(passed, 200);
  EXPECT_EQ(others, 0);
}

// Of a million sizes the least and the greatest come within 1 % of the ends where the law is flat.
TEST(DrawnShares, OfAPowerLawLieBetweenTheStatedEnds) {
  const std::size_t pieces = 1000000;
  const auto shares = drawnShares(Sizes::power, 1.0, pieces, 0.0, 2);
  const auto [least, most] = std::minmax_element(shares.begin(), shares.end());
  EXPECT_NEAR(*most / *least, kPowerSpan, 0.01 * kPowerSpan);
  EXPECT_NEAR(*least * static_cast<double>(pieces) * meanOfPower(1.0), 1.0, 0.01);
  // The mean of x^-1 from 1 to 1000 is 999 / ln 1000; of x^-2 it is ln 1000 / (1 - 1/1000).
  EXPECT_NEAR(meanOfPower(1.0), 999.0 / std::log(1000.0), 1e-9);
  EXPECT_NEAR(meanOfPower(2.0), std::log(1000.0) / 0.999, 1e-9);
}

TEST(DrawnShares, RefuseParametersOutOfRange) {
  const auto refused = [](Sizes sizes, double parameter, double least) {
    try {
      (void)drawnShares(sizes, parameter, 10, least, 0);
    } catch (const Error& e) {
      return e.code() == ErrorCode::usage;
    }
    return false;
  };
  EXPECT_TRUE(refused(Sizes::grown, 0.0, 0.0));
  EXPECT_TRUE(refused(Sizes::uniform, 0.0, 0.11));
  for (const double bad : {-1.0, 0.0, 0.9, 4.1, std::nan("")}) {
    EXPECT_TRUE(refused(Sizes::power, bad, 0.0)) << bad;
  }
  for (const double bad : {-1.0, 0.0, 3.1, std::nan("")}) {
    EXPECT_TRUE(refused(Sizes::lognormal, bad, 0.0)) << bad;
  }
}

}  // namespace
}  // namespace sherd
