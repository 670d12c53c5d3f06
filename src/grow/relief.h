// Amplitudes of the noise octaves of a rough crack.
#pragma once

#include <cstdint>
#include <vector>

namespace sherd {

/// The amplitudes, in 1/256 voxel, of the octaves with lattice spacings of 2, 4, 8, ... voxels that
/// give a flat crack an rms height of `roughness` voxels over a square window.
///   roughness  voxels, >= 0
///   hurst      0..1
///   window     side of the window in voxels
[[nodiscard]] std::vector<std::int32_t> octaveAmplitudes(double roughness, double hurst,
                                                         double window);

}  // namespace sherd
