// Octaves of the noise of a rough crack.
#pragma once

#include <cstdint>
#include <vector>

namespace sherd {

/// The relief of a rough crack.  All lengths are in voxels.
struct Relief {
  double height = 0.0;       ///< rms height over a square window, >= 0
  double hurst = 0.8;        ///< 0..1, along the axes other than that of propagation
  double window = 0.0;       ///< side of the window; below half a voxel it counts as half a voxel
  double longestSide = 0.0;  ///< S, the longest side of the mesh's box, at least 1
  double propagationHurst = 0.0;  ///< along the axis of propagation, 0..1; 0: as hurst
  std::int32_t propagation = 2;   ///< this axis, 0..2
};

/// The octaves with lattices of at least two voxels, coarsest first.
struct NoiseOctaves {
  std::int32_t first = 0;        ///< number of the coarsest; octave k has a least spacing of S/2^k
  std::int32_t propagation = 2;  ///< the axis of propagation
  std::vector<std::int64_t> step{};  ///< spacings per voxel, in units of 2^-32, along other axes
  std::vector<std::int64_t> propagationStep{};  ///< the same along that of propagation
  std::vector<std::int32_t> amplitude{};        ///< largest lattice value, 1/256 voxel
};

/// Returns the octaves that give a flat crack the height of `relief`.  The height is that of all
/// octaves down to a spacing of S/4096, so octaves have the same amplitude, as a length, at every
/// voxel size.  The finest that the voxels do not resolve are missing from it: at S = 128 voxels, a
/// window of S/10 and a Hurst exponent of 0.8, 0.5 % of the height; at an exponent of 0.5, 4 %.
///
/// With two exponents the amplitude is proportional to s^hurst and to t^propagationHurst, s and t
/// being the spacings along the axes other than that of propagation and along it: heights d apart
/// differ by d^hurst and d^propagationHurst.  The exponent that is larger has the larger spacings,
/// (t/S) = (s/S)^(hurst/propagationHurst), and the smaller spacing of an octave is S/2^k.  The
/// height is that over a window with a side along propagation.
[[nodiscard]] NoiseOctaves noiseOctaves(const Relief& relief);

}  // namespace sherd
