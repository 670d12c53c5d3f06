// The variance of value noise, octave by octave.
#include "grow/relief.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace sherd {
namespace {

// Returns the integral of f over a..b by Simpson's rule.
double integral(double a, double b, const std::function<double(double)>& f) {
  constexpr int kIntervals = 200;
  const double h = (b - a) / kIntervals;
  double sum = f(a) + f(b);
  for (int i = 1; i < kIntervals; ++i) sum += (i % 2 ? 4.0 : 2.0) * f(a + i * h);
  return sum * h / 3.0;
}

// Returns the weight of a lattice point at a distance of x spacings.
double bump(double x) {
  const double t = std::min(std::abs(x), 1.0);
  return 1.0 - t * t * t * (6.0 * t * t - 15.0 * t + 10.0);
}

// Returns the correlation, averaged over phases, of value noise along one axis for independent
// lattice values of variance 1: the autocorrelation of the bump.
double correlation(double x) {
  if (std::abs(x) >= 2.0) return 0.0;
  return integral(-1.0, 1.0, [&](double u) { return bump(u) * bump(u + x); });
}

// Returns the variance of one octave within a square window of `spacings` lattice spacings for
// lattice values uniform on -1..1: the correlation at lag 0 minus its mean over all pairs of
// points.
double varianceInWindow(double spacings) {
  const double atPoint = correlation(0.0);
  const double pairs =  // mean over pairs, one axis; the correlation is 0 from 2 spacings on
      2.0 * integral(0.0, std::min(1.0, 2.0 / spacings),
                     [&](double t) { return (1.0 - t) * correlation(t * spacings); });
  return (atPoint * atPoint * atPoint - atPoint * pairs * pairs) / 3.0;
}

}  // namespace

std::vector<std::int32_t> octaveAmplitudes(double roughness, double hurst, double window) {
  // The largest lattice spacing is at least four windows: the relief extends beyond a window.
  std::vector<double> spacing;
  for (double s = 2.0; spacing.empty() || spacing.back() < 4.0 * window; s *= 2.0) {
    spacing.push_back(s);
  }
  // Over a distance d, lattices with spacing > d contribute d^2 spacing^(2H-2), which decreases
  // slowly: without them C(d) bends well below the largest spacing.  The last octave includes their
  // variance.
  constexpr int kOctavesBeyond = 16;  // more matter only near H = 1, where the sum diverges
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
