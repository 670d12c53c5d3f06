// Octaves of the noise of a rough crack.
#pragma once

#include <cstdint>
#include <vector>

namespace sherd {

/// The relief of a rough crack.  All lengths are in voxels.
struct Relief {
  double height = 0.0;       ///< rms height over a square window, >= 0
  double hurst = 0.8;        ///< 0..1
  double window = 0.0;       ///< side of the window; below half a voxel it counts as half a voxel
  double longestSide = 0.0;  ///< S, the longest side of the mesh's box, at least 1
};

/// The octaves with lattices of at least two voxels, coarsest first.
struct NoiseOctaves {
  std::int32_t first = 0;            ///< number of the coarsest; octave k has a spacing of S/2^k
  std::vector<std::int64_t> step{};  ///< spacings per voxel, in units of 2^-32
  std::vector<std::int32_t> amplitude{};  ///< largest lattice value, 1/256 voxel
};

/// Returns the octaves that give a flat crack the height of `relief`.  The height is that of all
/// octaves down to a spacing of S/4096, so octaves have the same amplitude, as a length, at every
/// voxel size.  The finest that the voxels do not resolve are missing from it: at S = 128 voxels, a
/// window of S/10 and a Hurst exponent of 0.8, 0.5 % of the height; at an exponent of 0.5, 4 %.
[[nodiscard]] NoiseOctaves noiseOctaves(const Relief& relief);

}  // namespace sherd
