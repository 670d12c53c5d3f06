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

constexpr int kFinest = 12;    // S/4096
constexpr int kCoarsest = -8;  // 256 S: the noise is almost constant in the mesh's box

// Returns the lattice spacing of an octave, in voxels.
double spacingOf(const Relief& relief, int octave) {
  return std::ldexp(relief.longestSide, -octave);
}

// Returns the finest octave whose lattice is at least four windows wide: the relief extends beyond
// a window.
int firstOctave(const Relief& relief) {
  constexpr double kRounding = 1e-9;  // of lengths that are equal in other voxels
  int octave = kFinest;
  while (octave > kCoarsest &&
         spacingOf(relief, octave) < (1.0 - kRounding) * 4.0 * relief.window) {
    --octave;
  }
  return octave;
}

// Returns the amplitudes of the octaves from `first` to kFinest, in voxels.
std::vector<double> amplitudesFrom(int first, const Relief& relief) {
  // Over a distance d, lattices with spacing > d contribute d^2 spacing^(2H-2), which decreases
  // slowly: without them C(d) bends well below the largest spacing.  The first octave includes
  // their variance.
  constexpr int kOctavesBeyond = 16;  // more matter only near H = 1, where the sum diverges
  double beyond = 0.0;
  for (int k = 0; k <= kOctavesBeyond; ++k) beyond += std::pow(2.0, k * (2.0 * relief.hurst - 2.0));
  std::vector<double> amplitude;
  for (int k = first; k <= kFinest; ++k) {
    amplitude.push_back(std::pow(2.0, (first - k) * relief.hurst));
  }
  amplitude.front() *= std::sqrt(beyond);
  double variance = 0.0;
  for (std::size_t i = 0; i < amplitude.size(); ++i) {
    const double spacing = spacingOf(relief, first + static_cast<int>(i));
    variance += amplitude[i] * amplitude[i] * varianceInWindow(relief.window / spacing);
  }
  for (double& a : amplitude) a *= relief.height / std::sqrt(variance);
  return amplitude;
}

}  // namespace

NoiseOctaves noiseOctaves(const Relief& relief) {
  constexpr double kLeastSpacing = 2.0 * (1.0 - 1e-9);  // voxels
  constexpr double kLargestAmplitude = 1 << 22;         // kernels have 32 bits
  Relief wide = relief;
  wide.window = std::max(relief.window, 0.5);
  NoiseOctaves octaves{.first = firstOctave(wide)};
  int octave = octaves.first;
  for (const double amplitude : amplitudesFrom(octaves.first, wide)) {
    const double spacing = spacingOf(wide, octave++);
    if (spacing < kLeastSpacing) break;
    octaves.step.push_back(std::min(std::llround(0x1p32 / spacing), 1ll << 31));
    octaves.amplitude.push_back(
        static_cast<std::int32_t>(std::lround(std::min(256.0 * amplitude, kLargestAmplitude))));
  }
  return octaves;
}

}  // namespace sherd
