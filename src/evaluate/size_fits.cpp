// Fits distributions to the sizes of fragments, and tests the fits.
#include <sherd/evaluate.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "base/cancel_flag.h"
#include "base/random.h"

namespace sherd {
namespace {

constexpr std::size_t kLeastSizes = 5;
constexpr std::size_t kMostDrawn = 1000;  // sizes in a simulated sample

using Values = std::vector<double>;
using Cumulative = std::function<double(double)>;

double meanOf(const Values& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The largest distance between a sample's distribution and a continuous one.
///   sorted  ascending
double distanceOf(const Values& sorted, const Cumulative& cumulative) {
  const auto n = static_cast<double>(sorted.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double expected = cumulative(sorted[i]), below = static_cast<double>(i) / n;
    distance = std::max({distance, expected - below, below + 1.0 / n - expected});
  }
  return distance;
}

/// A family of distributions of one kind of values, which need not be the sizes themselves.
struct Family {
  std::function<double(const Values&)> parameterOf;  ///< maximum likelihood, of sorted values
  std::function<Cumulative(const Values&)> fit;      ///< of sorted values
  std::function<double(double, double)> draw;        ///< of two uniform numbers in (0, 1)
  std::function<double(double, double)> modified;    ///< distance and count: of Stephens
  Stage stage;
};

/// Returns the share of simulated samples, and of this one, that are at least as far from their
/// fit.
double pValueOf(const Family& family, std::size_t count, double distance, std::size_t simulations,
                std::uint64_t seed, const Progress* progress) {
  const std::size_t drawn = std::min(count, kMostDrawn);
  const double observed = family.modified(distance, static_cast<double>(count));
  std::vector<char> further(simulations);
  tbb::parallel_for(std::size_t{0}, simulations, [&](std::size_t k) {
    throwIfCancelled(progress);
    const std::uint64_t own = randomBits(seed, family.stage, k);
    Values values(drawn);
    for (std::size_t i = 0; i < drawn; ++i) {
      const double a = randomUnit(own, family.stage, 2 * i) + 0x1p-54;
      values[i] = family.draw(a, randomUnit(own, family.stage, 2 * i + 1));
    }
    std::sort(values.begin(), values.end());
    const double simulated = distanceOf(values, family.fit(values));
    further[k] = family.modified(simulated, static_cast<double>(drawn)) >= observed;
  });
  const auto count1 = 1 + std::count(further.begin(), further.end(), 1);
  return static_cast<double>(count1) / static_cast<double>(simulations + 1);
}

DistributionFit fitOf(const Family& family, const Values& sorted, double standardError,
                      std::size_t simulations, std::uint64_t seed, const Progress* progress) {
  DistributionFit fit;
  fit.parameter = family.parameterOf(sorted);
  fit.standardError = standardError;
  fit.distance = distanceOf(sorted, family.fit(sorted));
  fit.pValue = pValueOf(family, sorted.size(), fit.distance, simulations, seed, progress);
  return fit;
}

// Distances of samples of different sizes, made comparable: exact for equal sizes.
double modifiedExponential(double d, double n) {
  return (d - 0.2 / n) * (std::sqrt(n) + 0.26 + 0.5 / std::sqrt(n));
}
double modifiedNormal(double d, double n) {
  return d * (std::sqrt(n) - 0.01 + 0.85 / std::sqrt(n));
}
double modifiedKnown(double d, double n) { return d * (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)); }

Family exponentialFamily() {
  return {meanOf,
          [](const Values& x) -> Cumulative {
            return [mean = meanOf(x)](double v) { return -std::expm1(-v / mean); };
          },
          [](double u, double) { return -std::log(u); }, modifiedExponential,
          Stage::statisticsExponential};
}

double deviationOf(const Values& x) {
  const double mean = meanOf(x);
  double squares = 0.0;
  for (const double v : x) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / (static_cast<double>(x.size()) - 1.0));
}

/// Of logarithms.
Family normalFamily() {
  return {deviationOf,
          [](const Values& x) -> Cumulative {
            return [mean = meanOf(x), deviation = deviationOf(x)](double v) {
              return 0.5 * std::erfc((mean - v) / (deviation * std::numbers::sqrt2));
            };
          },
          [](double u, double v) {
            return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
          },
          modifiedNormal, Stage::statisticsNormal};
}

// A power law between two bounds: y = log(size / least) has density b exp(-b y) / (1 - exp(-b l))
// on 0..l, with b = tau - 1 and l = log(greatest / least).

/// The mean of y / l, for x = b l: 1 / x - 1 / (exp(x) - 1).
double meanOfBounded(double x) {
  return std::abs(x) < 1e-4 ? 0.5 - x / 12.0 : 1.0 / x - 1.0 / std::expm1(x);
}

/// The variance of y / l.
double varianceOfBounded(double x) {
  if (std::abs(x) < 1e-2) return 1.0 / 12.0 - x * x / 240.0;
  const double s = 2.0 * std::sinh(x / 2.0);
  return 1.0 / (x * x) - 1.0 / (s * s);
}

/// Returns x = b l, by bisection: the mean falls with it.
double bounded(const Values& y, double length) {
  const double mean = meanOf(y) / length;
  double low = -600.0, high = 600.0;
  for (int step = 0; step < 64; ++step) {
    const double middle = 0.5 * (low + high);
    (meanOfBounded(middle) > mean ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double boundedCumulative(double y, double x, double length) {
  const double share = std::clamp(y / length, 0.0, 1.0);
  return std::abs(x) < 1e-9 ? share : std::expm1(-x * share) / std::expm1(-x);
}

/// Of y, without the least and the greatest size, which are the bounds.
Family boundedFamily(double x, double length) {
  return {[length](const Values& y) { return 1.0 + bounded(y, length) / length; },
          [length](const Values& y) -> Cumulative {
            return [length, x = bounded(y, length)](double v) {
              return boundedCumulative(v, x, length);
            };
          },
          [x, length](double u, double) {
            if (std::abs(x) < 1e-9) return u * length;
            return -std::log1p(u * std::expm1(-x)) / x * length;
          },
          modifiedKnown, Stage::statisticsPower};
}

std::optional<DistributionFit> powerFit(const Values& sorted, std::size_t simulations,
                                        std::uint64_t seed, const Progress* progress) {
  const double length = std::log(sorted.back() / sorted.front());
  if (!(length > 1e-9)) return {};
  Values inner;
  for (std::size_t i = 1; i + 1 < sorted.size(); ++i) {
    inner.push_back(std::log(sorted[i] / sorted.front()));
  }
  const double x = bounded(inner, length);
  const double error =
      1.0 / (length * std::sqrt(static_cast<double>(inner.size()) * varianceOfBounded(x)));
  return fitOf(boundedFamily(x, length), inner, error, simulations, seed, progress);
}

}  // namespace

SizeFits fitSizes(std::span<const double> sizes, std::size_t simulations, std::uint64_t seed,
                  const Progress* progress) {
  Values sorted;
  std::copy_if(sizes.begin(), sizes.end(), std::back_inserter(sorted),
               [](double size) { return size > 0.0; });
  std::sort(sorted.begin(), sorted.end());
  SizeFits fits;
  fits.count = sorted.size();
  if (sorted.empty()) return fits;
  fits.mean = meanOf(sorted);
  fits.least = sorted.front();
  fits.greatest = sorted.back();
  if (fits.count < kLeastSizes) return fits;
  const auto n = static_cast<double>(fits.count);
  fits.exponential =
      fitOf(exponentialFamily(), sorted, fits.mean / std::sqrt(n), simulations, seed, progress);
  Values logarithms;
  for (const double size : sorted) logarithms.push_back(std::log(size));
  const double deviation = deviationOf(logarithms);
  if (deviation > 1e-9) {
    fits.lognormal = fitOf(normalFamily(), logarithms, deviation / std::sqrt(2.0 * (n - 1.0)),
                           simulations, seed, progress);
  }
  fits.power = powerFit(sorted, simulations, seed, progress);
  return fits;
}

}  // namespace sherd
