// Self-affine noise: a random function of space whose differences grow with distance by a power.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace sherd {

/// Returns the weight of a lattice value at a distance of x spacings along one axis: 1 at 0, 0 from
/// 1 on, with two continuous derivatives.
///   source  Perlin, Improving noise, 2002
[[nodiscard]] double latticeWeight(double x);

/// Returns its derivative.
[[nodiscard]] double latticeWeightSlope(double x);

/// All lengths are in the unit of the positions.
struct SelfAffineShape {
  double rms = 0.0;       ///< over all of space, >= 0
  double hurst = 0.8;     ///< 0.1..1: heights d apart differ by d^hurst, up to a third of `longest`
  double longest = 1.0;   ///< > 0; heights farther apart are nearly independent
  double shortest = 0.0;  ///< no waves shorter than this; > 0, or as `longest` if that is less
};

/// A value, and how it changes per unit of length.
struct SlopedValue {
  double value = 0.0;
  glm::dvec3 gradient{0.0};
};

/// A sum of octaves of value noise on cubic lattices whose spacings are `longest` over powers of
/// two.  Each lattice has a position and orientation of its own, so that no direction and no plane
/// of space is preferred.  The mean is 0.
///   source  Perlin, An image synthesizer, 1985; Musgrave, Kolb, Mace, The synthesis and rendering
///           of eroded fractal terrains, 1989
class SelfAffineNoise {
 public:
  SelfAffineNoise(const SelfAffineShape& shape, std::uint64_t seed);

  /// Returns the value at a position.
  [[nodiscard]] double at(const glm::dvec3& position) const;

  /// Returns the same value, with its gradient.
  [[nodiscard]] SlopedValue slopedAt(const glm::dvec3& position) const;

 private:
  struct Octave {
    glm::dmat3 lattice{1.0};  ///< lattice coordinates from positions
    glm::dvec3 shift{0.0};
    double amplitude = 0.0;
    std::uint64_t seed = 0;
  };
  std::vector<Octave> octaves_;
};

}  // namespace sherd
