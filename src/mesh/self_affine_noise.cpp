// Self-affine noise: octaves of value noise.
#include "mesh/self_affine_noise.h"

#include <algorithm>
#include <array>
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

// The eight lattice values around a position, and where it is between them.
struct LatticeCell {
  std::array<double, 8> values{};  // [x + 2 y + 4 z]
  glm::dvec3 low{0.0};             // 0..1
};

LatticeCell cellAt(const glm::dvec3& at, std::uint64_t seed) {
  const glm::dvec3 cell = glm::floor(at);
  LatticeCell out;
  out.low = at - cell;
  for (int corner = 0; corner < 8; ++corner) {
    out.values[static_cast<std::size_t>(corner)] =
        latticeValue(seed, static_cast<std::int64_t>(cell.x) + (corner & 1),
                     static_cast<std::int64_t>(cell.y) + ((corner >> 1) & 1),
                     static_cast<std::int64_t>(cell.z) + (corner >> 2));
  }
  return out;
}

// Returns the weights along each axis of the values on the low side, of those on the high side.
std::array<glm::dvec3, 2> weightsOf(const glm::dvec3& low) {
  const glm::dvec3 weight{latticeWeight(low.x), latticeWeight(low.y), latticeWeight(low.z)};
  return {weight, 1.0 - weight};
}

// Returns the sum of the values, each times a weight of each axis.
double weighted(const LatticeCell& cell, const std::array<glm::dvec3, 2>& x,
                const std::array<glm::dvec3, 2>& y, const std::array<glm::dvec3, 2>& z) {
  double sum = 0.0;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    sum += x[corner & 1].x * y[(corner >> 1) & 1].y * z[corner >> 2].z * cell.values[corner];
  }
  return sum;
}

}  // namespace

double latticeWeight(double x) {
  const double t = std::min(std::abs(x), 1.0);
  return 1.0 - t * t * t * (6.0 * t * t - 15.0 * t + 10.0);
}

double latticeWeightSlope(double x) {
  const double t = std::min(std::abs(x), 1.0);
  return std::copysign(30.0 * t * t * (1.0 - t) * (1.0 - t), -x);
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
    const LatticeCell cell = cellAt(octave.lattice * position + octave.shift, octave.seed);
    const auto weights = weightsOf(cell.low);
    sum += octave.amplitude * weighted(cell, weights, weights, weights);
  }
  return sum;
}

SlopedValue SelfAffineNoise::slopedAt(const glm::dvec3& position) const {
  SlopedValue sum;
  for (const Octave& octave : octaves_) {
    const LatticeCell cell = cellAt(octave.lattice * position + octave.shift, octave.seed);
    const auto weights = weightsOf(cell.low);
    const glm::dvec3 slope{latticeWeightSlope(cell.low.x), latticeWeightSlope(cell.low.y),
                           latticeWeightSlope(cell.low.z)};
    const std::array slopes{slope, -slope};
    sum.value += octave.amplitude * weighted(cell, weights, weights, weights);
    const glm::dvec3 along{weighted(cell, slopes, weights, weights),
                           weighted(cell, weights, slopes, weights),
                           weighted(cell, weights, weights, slopes)};
    sum.gradient += octave.amplitude * (along * octave.lattice);
  }
  return sum;
}

}  // namespace sherd
