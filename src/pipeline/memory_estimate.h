// Estimates of memory beyond those for a mesh.
#pragma once

#include <cstdint>

namespace sherd {

/// The most voxels along a solid's longest side that a preview shows; finer solids are coarsened to
/// this many.
inline constexpr double kPreviewCubes = 768.0;

/// Estimates the bytes that breaking a solid takes at most; see the one for a mesh.
///   surface, inside  numbers of voxels
[[nodiscard]] std::uint64_t estimatedMemory(double surface, double inside);

}  // namespace sherd
