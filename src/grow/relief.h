// How strong the octaves of a rough crack must be.
#pragma once

#include <cstdint>
#include <vector>

namespace sherd {

/// The amplitudes of the octaves with lattices of 2, 4, 8, ... voxels, in 1/256 voxels, that give a
/// flat crack an rms height of `roughness` voxels over a square window of `window` voxels.
///   roughness  voxels, >= 0
///   hurst      0..1
[[nodiscard]] std::vector<std::int32_t> octaveAmplitudes(double roughness, double hurst,
                                                         double window);

}  // namespace sherd
