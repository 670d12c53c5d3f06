// Self-affine noise: octaves of value noise.
#include "mesh/self_affine_noise.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/random.h"

namespace sherd {
namespace {

// The variance of value noise at a point, averaged over the lattice's positions, for lattice values
// uniform on -1..1: along each axis the integral of the squared weight over -1..1, 181/231.
constexpr double kAlongAxis = 181.0 / 231.0;
constexpr double kVariance = kAlongAxis * kAlongAxis * kAlongAxis / 3.0;

constexpr int kMostOctaves = 24;

// Returns x^y, rounded, so that it does not depend on the system's mathematical library.
double roundedPower(double x, double y) { return 0x1p-40 * std::round(0x1p40 * std::pow(x, y)); }

// Returns the factor of the variance of the first octave.  A lattice with a spacing of s counts as
// s^(2 hurst - 2) for distances far below it, which falls slowly, so that without the lattices of
// larger spacings differences would grow more slowly than by the exponent: the first stands for
// these too.
double withLarger(double hurst) {
  constexpr int kLattices = 16;  // more matter only near an exponent of 1, where the sum diverges
  const double ratio = roundedPower(2.0, 2.0 * hurst - 2.0);
  double sum = 0.0, term = 1.0;
  for (int k = 0; k <= kLattices; ++k, term *= ratio) sum += term;
  return sum;
}

double fractionOf(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

// Returns the value of a lattice point, uniform on -1..1.
double latticeValue(std::uint64_t seed, std::int64_t i, std::int64_t j, std::int64_t k) {
  std::uint64_t hash = mixed(seed ^ static_cast<std::uint64_t>(i));
  hash = mixed(hash + 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(j));
  hash = mixed(hash + 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(k));
  return 2.0 * fractionOf(hash) - 1.0;
}

// Returns a random rotation: a random point of the four-dimensional ball, scaled to length 1.
//   source  Marsaglia, Choosing a point from the surface of a sphere, 1972
glm::dmat3 rotationOf(std::uint64_t seed) {
  for (std::uint64_t draw = 0;; draw += 4) {
    const auto number = [&](std::uint64_t k) {
      return 2.0 * fractionOf(mixed(seed + draw + k)) - 1.0;
    };
    const glm::dquat point(number(0), number(1), number(2), number(3));
    const double squared = glm::dot(point, point);
    if (squared <= 1.0 && squared > 1e-4) return glm::mat3_cast(point / std::sqrt(squared));
  }
}

}  // namespace

double latticeWeight(double x) {
  const double t = std::min(std::abs(x), 1.0);
  return 1.0 - t * t * t * (6.0 * t * t - 15.0 * t + 10.0);
}

SelfAffineNoise::SelfAffineNoise(const SelfAffineShape& shape, std::uint64_t seed) {
  double spacing = shape.longest, variance = 0.0;
  for (int k = 0; k < kMostOctaves && (k == 0 || spacing >= shape.shortest); ++k) {
    const std::uint64_t own = mixed(seed + 0x9e3779b97f4a7c15u * static_cast<std::uint64_t>(k + 1));
    Octave octave;
    octave.lattice = rotationOf(own) / spacing;
    octave.shift = {fractionOf(mixed(~own)), fractionOf(mixed(~own + 1)),
                    fractionOf(mixed(~own + 2))};
    octave.amplitude = roundedPower(spacing / shape.longest, shape.hurst);
    if (k == 0) octave.amplitude = std::sqrt(withLarger(shape.hurst));
    octave.seed = own;
    variance += kVariance * octave.amplitude * octave.amplitude;
    octaves_.push_back(octave);
    spacing *= 0.5;
  }
  for (Octave& octave : octaves_) octave.amplitude *= shape.rms / std::sqrt(variance);
}

double SelfAffineNoise::at(const glm::dvec3& position) const {
  double sum = 0.0;
  for (const Octave& octave : octaves_) {
    const glm::dvec3 at = octave.lattice * position + octave.shift, cell = glm::floor(at);
    const glm::dvec3 low = at - cell;
    const glm::dvec3 weight{latticeWeight(low.x), latticeWeight(low.y), latticeWeight(low.z)};
    double value = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 step{corner & 1, (corner >> 1) & 1, corner >> 2};
      const glm::dvec3 far(step);
      const glm::dvec3 w = far + (1.0 - 2.0 * far) * weight;
      value += w.x * w.y * w.z *
               latticeValue(octave.seed, static_cast<std::int64_t>(cell.x) + step.x,
                            static_cast<std::int64_t>(cell.y) + step.y,
                            static_cast<std::int64_t>(cell.z) + step.z);
    }
    sum += octave.amplitude * value;
  }
  return sum;
}

}  // namespace sherd
