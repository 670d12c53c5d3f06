// The variance of value noise, octave by octave.
#include "grow/relief.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace sherd {
namespace {

// Integral of f over a..b by Simpson's rule.
double integral(double a, double b, const std::function<double(double)>& f) {
  constexpr int kIntervals = 200;
  const double h = (b - a) / kIntervals;
  double sum = f(a) + f(b);
  for (int i = 1; i < kIntervals; ++i) sum += (i % 2 ? 4.0 : 2.0) * f(a + i * h);
  return sum * h / 3.0;
}

// How much of a lattice point is felt at a distance of x spacings.
double bump(double x) {
  const double t = std::min(std::abs(x), 1.0);
  return 1.0 - t * t * t * (6.0 * t * t - 15.0 * t + 10.0);
}

// Correlation along one axis of value noise with independent lattice values of variance 1, over all
// phases: the bump's with itself.
double correlation(double x) {
  if (std::abs(x) >= 2.0) return 0.0;
  return integral(-1.0, 1.0, [&](double u) { return bump(u) * bump(u + x); });
}

// Variance of one octave within a square window of `spacings` lattice spacings, lattice values
// being uniform on -1..1: the correlation at a point less its mean over all pairs of points.
double varianceInWindow(double spacings) {
  const double atPoint = correlation(0.0);
  const double pairs =  // the mean over pairs, one axis; the correlation ends at 2 spacings
      2.0 * integral(0.0, std::min(1.0, 2.0 / spacings),
                     [&](double t) { return (1.0 - t) * correlation(t * spacings); });
  return (atPoint * atPoint * atPoint - atPoint * pairs * pairs) / 3.0;
}

}  // namespace

std::vector<std::int32_t> octaveAmplitudes(double roughness, double hurst, double window) {
  // The largest lattice is four times the window or more: the relief goes on beyond it.
  std::vector<double> spacing;
  for (double s = 2.0; spacing.empty() || spacing.back() < 4.0 * window; s *= 2.0) {
    spacing.push_back(s);
  }
  // Over a distance d lattices larger than d still count, as d^2 spacing^(2H-2), which falls
  // slowly: without them C(d) bends long before the largest lattice.  The last octave stands for
  // them all.
  constexpr int kOctavesBeyond = 16;  // more would count only near H = 1, where the sum is endless
  double beyond = 0.0;
  for (int k = 0; k <= kOctavesBeyond; ++k) beyond += std::pow(2.0, k * (2.0 * hurst - 2.0));
  std::vector<double> relative;
  for (const double s : spacing) relative.push_back(std::pow(s, hurst));
  relative.back() *= std::sqrt(beyond);
  double variance = 0.0;
  for (std::size_t i = 0; i < spacing.size(); ++i) {
    variance += relative[i] * relative[i] * varianceInWindow(window / spacing[i]);
  }
  const double scale = roughness / std::sqrt(variance);
  std::vector<std::int32_t> amplitudes;
  for (const double r : relative) {
    amplitudes.push_back(static_cast<std::int32_t>(std::lround(256.0 * scale * r)));
  }
  return amplitudes;
}

}  // namespace sherd
