// Estimators of size distributions' parameters, which do not depend on the sum of the sizes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace sherd::estimators {

struct Estimate {
  double value = 0.0;
  double standardError = 0.0;
};

struct Moments {
  double mean = 0.0, variance = 0.0;
};

inline Moments logMoments(std::span<const double> sizes) {
  Moments m;
  const auto n = static_cast<double>(sizes.size());
  for (const double size : sizes) m.mean += std::log(size) / n;
  for (const double size : sizes) m.variance += std::pow(std::log(size) - m.mean, 2.0) / n;
  return m;
}

/// The maximum-likelihood estimate of the standard deviation of a lognormal's logarithm.
inline Estimate lognormal(std::span<const double> sizes) {
  const double s = std::sqrt(logMoments(sizes).variance);
  return {s, s / std::sqrt(2.0 * static_cast<double>(sizes.size()))};
}

/// The maximum-likelihood estimate of the exponent of a power law truncated at both ends.
///   source  Aban, Meerschaert and Panorska, Parameter Estimation for the Truncated Pareto
///           Distribution, 2006
inline Estimate power(std::span<const double> sizes) {
  const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
  const double span = std::log(*most / *least);
  const Moments m = logMoments(sizes);
  const double mean = m.mean - std::log(*least);
  // The logarithm over the least is exponential with the rate a, truncated at the span: its mean is
  // 1 / a - span / (exp(a span) - 1), which falls with a.
  double low = -5.0, high = 10.0;
  for (int i = 0; i < 100; ++i) {
    const double a = 0.5 * (low + high);
    const double expected =
        std::abs(a * span) < 1e-6 ? span / 2.0 : 1.0 / a - span / std::expm1(a * span);
    (expected > mean ? low : high) = a;
  }
  return {1.0 + low, 1.0 / std::sqrt(m.variance * static_cast<double>(sizes.size()))};
}

/// Whether Lilliefors' test at 5 % does not refuse that the sizes are exponential.
///   source  Stephens, EDF Statistics for Goodness of Fit and Some Comparisons, 1974, table 4
inline bool isExponential(std::vector<double> sizes) {
  std::sort(sizes.begin(), sizes.end());
  const auto n = static_cast<double>(sizes.size());
  double mean = 0.0, distance = 0.0;
  for (const double size : sizes) mean += size / n;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double f = -std::expm1(-sizes[i] / mean), at = static_cast<double>(i);
    distance = std::max({distance, f - at / n, (at + 1.0) / n - f});
  }
  return (distance - 0.2 / n) * (std::sqrt(n) + 0.26 + 0.5 / std::sqrt(n)) < 1.094;
}

}  // namespace sherd::estimators
