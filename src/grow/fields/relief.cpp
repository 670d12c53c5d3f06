// The variance of value noise, octave by octave.
#include "grow/fields/relief.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "mesh/self_affine_noise.h"

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

// Returns the correlation, averaged over phases, of value noise along one axis for independent
// lattice values of variance 1: the autocorrelation of the weight.
double correlation(double x) {
  if (std::abs(x) >= 2.0) return 0.0;
  return integral(-1.0, 1.0, [&](double u) { return latticeWeight(u) * latticeWeight(u + x); });
}

// Returns the mean correlation over all pairs of points of a line of `spacings` lattice spacings;
// the correlation is 0 from 2 spacings on.
double meanOverPairs(double spacings) {
  return 2.0 * integral(0.0, std::min(1.0, 2.0 / spacings),
                        [&](double t) { return (1.0 - t) * correlation(t * spacings); });
}

// Returns the variance of one octave within a window of sides `a` and `b`, in lattice spacings, for
// lattice values uniform on -1..1: the correlation at lag 0 minus its mean over all pairs of
// points.
double varianceInWindow(double a, double b) {
  const double atPoint = correlation(0.0);
  const double alongA = meanOverPairs(a), alongB = a == b ? alongA : meanOverPairs(b);
  return (atPoint * atPoint * atPoint - atPoint * alongA * alongB) / 3.0;
}

constexpr int kFinest = 12;    // S/4096
constexpr int kCoarsest = -8;  // 256 S: the noise is almost constant in the mesh's box

// An axis of a lattice: its spacing in octave k is S / 2^(k rate), and heights d apart along it
// differ by d^hurst.
struct LatticeAxis {
  double hurst = 0.0;
  double rate = 1.0;  // at most 1

  [[nodiscard]] double spacing(double longestSide, double octave) const {
    if (rate == 1.0) return std::ldexp(longestSide, -static_cast<int>(octave));
    return longestSide * std::exp2(-rate * octave);
  }

  // Returns the variance over a distance far below the spacings of all octaves from the first to
  // coarser ones, relative to that of the first.  A lattice with a spacing of s contributes
  // s^(2 hurst - 2), which decreases slowly.
  [[nodiscard]] double beyond() const {
    constexpr int kOctaves = 16;  // more matter only near an exponent of 1, where the sum diverges
    double sum = 0.0;
    for (int k = 0; k <= kOctaves; ++k) sum += std::pow(2.0, k * rate * (2.0 * hurst - 2.0));
    return sum;
  }
};

// The amplitude of an octave is spacing^hurst along both: hurst * rate is the same.
struct LatticeAxes {
  LatticeAxis front, propagation;
};

LatticeAxes axesOf(const Relief& relief) {
  const double along = relief.propagationHurst > 0.0 ? relief.propagationHurst : relief.hurst;
  const double least = std::min(relief.hurst, along);
  return {{relief.hurst, least / relief.hurst}, {along, least / along}};
}

// An octave in double precision; lengths in voxels.
struct Octave {
  double spacing = 0.0, propagationSpacing = 0.0, amplitude = 0.0;
};

// Returns the finest octave whose lattice is at least four windows wide: the relief extends beyond
// a window.
int firstOctave(const Relief& relief) {
  constexpr double kRounding = 1e-9;  // of lengths that are equal in other voxels
  int octave = kFinest;
  while (octave > kCoarsest &&
         std::ldexp(relief.longestSide, -octave) < (1.0 - kRounding) * 4.0 * relief.window) {
    --octave;
  }
  return octave;
}

// Returns the octaves from `first` to kFinest.
std::vector<Octave> octavesFrom(int first, const Relief& relief) {
  const auto [front, propagation] = axesOf(relief);
  std::vector<Octave> octaves;
  for (int k = first; k <= kFinest; ++k) {
    octaves.push_back({front.spacing(relief.longestSide, k),
                       propagation.spacing(relief.longestSide, k),
                       std::pow(2.0, (first - k) * front.rate * relief.hurst)});
  }
  // Without coarser lattices the height-height correlation bends well below the largest spacing.
  // The first octave includes their variance: its amplitude is that of the axis to which they
  // contribute more, and its spacing along the other one is larger in turn.
  const double alongFront = front.beyond(), alongPropagation = propagation.beyond();
  octaves.front().amplitude *= std::sqrt(std::max(alongFront, alongPropagation));
  octaves.front().spacing *= std::sqrt(std::max(alongPropagation / alongFront, 1.0));
  octaves.front().propagationSpacing *= std::sqrt(std::max(alongFront / alongPropagation, 1.0));
  double variance = 0.0;
  for (const Octave& octave : octaves) {
    variance +=
        octave.amplitude * octave.amplitude *
        varianceInWindow(relief.window / octave.spacing, relief.window / octave.propagationSpacing);
  }
  for (Octave& octave : octaves) octave.amplitude *= relief.height / std::sqrt(variance);
  return octaves;
}

// Returns a lattice's spacings per voxel, in units of 2^-32.
std::int64_t stepOf(double spacing) { return std::min(std::llround(0x1p32 / spacing), 1ll << 31); }

}  // namespace

NoiseOctaves noiseOctaves(const Relief& relief) {
  constexpr double kLeastSpacing = 2.0 * (1.0 - 1e-9);  // voxels
  constexpr double kLargestAmplitude = 1 << 22;         // kernels have 32 bits
  Relief wide = relief;
  wide.window = std::max(relief.window, 0.5);
  NoiseOctaves octaves{.first = firstOctave(wide), .propagation = relief.propagation};
  int number = octaves.first;
  for (const Octave& octave : octavesFrom(octaves.first, wide)) {
    if (std::ldexp(wide.longestSide, -number++) < kLeastSpacing) break;
    octaves.step.push_back(stepOf(octave.spacing));
    octaves.propagationStep.push_back(stepOf(octave.propagationSpacing));
    octaves.amplitude.push_back(static_cast<std::int32_t>(
        std::lround(std::min(256.0 * octave.amplitude, kLargestAmplitude))));
  }
  return octaves;
}

}  // namespace sherd
