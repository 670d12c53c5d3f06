// Fits of sizes on numbers drawn from known distributions, by the C++ library's generators.
#include <gtest/gtest.h>
#include <sherd/evaluate.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace sherd {
namespace {

constexpr std::size_t kSimulations = 400;
constexpr double kErrors = 4.0;  // standard errors: missed once in 16000

using Draw = std::function<double(std::mt19937_64&)>;

std::vector<double> drawn(std::size_t count, std::uint64_t seed, const Draw& draw) {
  std::mt19937_64 random(seed);
  std::vector<double> values(count);
  for (double& value : values) value = draw(random);
  return values;
}

Draw exponential(double mean) {
  return [mean](std::mt19937_64& random) {
    return std::exponential_distribution<double>(1.0 / mean)(random);
  };
}

Draw lognormal(double s) {
  return
      [s](std::mt19937_64& random) { return std::lognormal_distribution<double>(-3.0, s)(random); };
}

// By the inverse of its cumulative distribution.
Draw power(double tau, double least, double greatest) {
  return [=](std::mt19937_64& random) {
    const double u = std::uniform_real_distribution<double>()(random), e = 1.0 - tau;
    if (std::abs(e) < 1e-12) return least * std::pow(greatest / least, u);
    return std::pow(std::pow(least, e) + u * (std::pow(greatest, e) - std::pow(least, e)), 1.0 / e);
  };
}

TEST(SizeFits, FindAnExponentialAndRejectOthers) {
  const SizeFits fits = fitSizes(drawn(500, 1, exponential(0.3)), kSimulations);
  ASSERT_TRUE(fits.exponential && fits.lognormal && fits.power);
  EXPECT_NEAR(fits.exponential->parameter, 0.3, kErrors * fits.exponential->standardError);
  EXPECT_NEAR(fits.exponential->standardError, 0.3 / std::sqrt(500.0), 0.003);
  EXPECT_GT(fits.exponential->pValue, 0.01);
  EXPECT_LT(fits.lognormal->pValue, 0.01);
  EXPECT_LT(fits.power->pValue, 0.01);
}

TEST(SizeFits, FindALognormalAndRejectOthers) {
  const SizeFits fits = fitSizes(drawn(500, 2, lognormal(0.8)), kSimulations);
  ASSERT_TRUE(fits.exponential && fits.lognormal && fits.power);
  EXPECT_NEAR(fits.lognormal->parameter, 0.8, kErrors * fits.lognormal->standardError);
  EXPECT_NEAR(fits.lognormal->standardError, 0.8 / std::sqrt(1000.0), 0.003);
  EXPECT_GT(fits.lognormal->pValue, 0.01);
  EXPECT_LT(fits.exponential->pValue, 0.01);
  EXPECT_LT(fits.power->pValue, 0.01);
}

TEST(SizeFits, FindThePowerBetweenTwoBounds) {
  for (const double tau : {0.5, 1.0, 1.35, 1.6, 2.5}) {
    const SizeFits fits = fitSizes(drawn(500, 3, power(tau, 0.001, 0.1)), kSimulations);
    ASSERT_TRUE(fits.exponential && fits.lognormal && fits.power) << tau;
    EXPECT_NEAR(fits.power->parameter, tau, kErrors * fits.power->standardError) << tau;
    EXPECT_LT(fits.power->standardError, 0.08) << tau;
    EXPECT_GT(fits.power->pValue, 0.05) << tau;
    EXPECT_LT(fits.lognormal->pValue, 0.01) << tau;
  }
}

// The errors that are reported are those of repeated fits.
TEST(SizeFits, StandardErrorsAreThoseOfRepeatedFits) {
  constexpr int kFits = 200;
  double sum = 0.0, squares = 0.0, errors = 0.0;
  for (int k = 0; k < kFits; ++k) {
    const SizeFits fits =
        fitSizes(drawn(300, 100 + static_cast<std::uint64_t>(k), power(1.6, 0.01, 1.0)), 1);
    sum += fits.power->parameter / kFits;
    squares += fits.power->parameter * fits.power->parameter / kFits;
    errors += fits.power->standardError / kFits;
  }
  const double deviation = std::sqrt(squares - sum * sum);
  EXPECT_NEAR(deviation / errors, 1.0, kErrors / std::sqrt(2.0 * kFits));
  EXPECT_NEAR(sum, 1.6, kErrors * errors / std::sqrt(kFits));
}

// p-values of true hypotheses are uniform; a test without Lilliefors' correction would rarely
// reject.
TEST(SizeFits, RejectATrueExponentialAsOftenAsTheLevel) {
  constexpr int kFits = 400;
  int rejected = 0, low = 0;
  for (int k = 0; k < kFits; ++k) {
    const SizeFits fits =
        fitSizes(drawn(50, 1000 + static_cast<std::uint64_t>(k), exponential(1.0)), 199);
    rejected += fits.exponential->pValue <= 0.05;
    low += fits.exponential->pValue <= 0.5;
  }
  EXPECT_NEAR(rejected, 0.05 * kFits, kErrors * std::sqrt(kFits * 0.05 * 0.95));
  EXPECT_NEAR(low, 0.5 * kFits, kErrors * std::sqrt(kFits * 0.25));
}

// Lilliefors 1969, table 1, corrected by Stephens 1974: of n = 20, the distance with p = 0.05 is
// 0.234; of n = 30, 0.192.  1967, table 1, of a normal distribution: 0.190 for 20, 0.161 for 30.
TEST(SizeFits, PValuesAreThoseOfTheTables) {
  struct Case {
    std::size_t count;
    double exponential, normal;
  };
  for (const Case& c : {Case{20, 0.234, 0.190}, {30, 0.192, 0.161}}) {
    std::vector<double> nearest{1.0, 1.0};
    int above = 0, aboveNormal = 0;
    constexpr int kFits = 3000;
    for (int k = 0; k < kFits; ++k) {
      const auto seed = 5000 + static_cast<std::uint64_t>(k);
      above += fitSizes(drawn(c.count, seed, exponential(1.0)), 1).exponential->distance >=
               c.exponential;
      aboveNormal +=
          fitSizes(drawn(c.count, seed, lognormal(1.0)), 1).lognormal->distance >= c.normal;
    }
    const double error = kErrors * std::sqrt(kFits * 0.05 * 0.95) + 0.005 * kFits;  // of 3 digits
    EXPECT_NEAR(above, 0.05 * kFits, error) << c.count;
    EXPECT_NEAR(aboveNormal, 0.05 * kFits, error) << c.count;
  }
}

TEST(SizeFits, LeaveOutWhatCannotBeFitted) {
  const std::vector<double> four{1.0, 2.0, 3.0, 4.0}, equal(20, 0.05), none{};
  EXPECT_FALSE(fitSizes(four).exponential || fitSizes(four).power || fitSizes(four).lognormal);
  EXPECT_EQ(fitSizes(four).mean, 2.5);
  EXPECT_FALSE(fitSizes(equal).power || fitSizes(equal).lognormal);
  EXPECT_LT(fitSizes(equal, kSimulations).exponential->pValue, 0.01);
  EXPECT_EQ(fitSizes(none).count, 0u);
  const std::vector<double> zeros{0.0, 0.0, 1.0, 2.0, 3.0};
  EXPECT_EQ(fitSizes(zeros).count, 3u);
}

}  // namespace
}  // namespace sherd
