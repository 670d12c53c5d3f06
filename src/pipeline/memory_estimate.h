// Estimates of memory beyond those for a mesh.
#pragma once

#include <sherd/fracture.h>

#include <cstdint>

namespace sherd {

/// The most voxels along a solid's longest side that a preview shows; finer solids are coarsened to
/// this many.
inline constexpr double kPreviewCubes = 768.0;

/// Estimates the bytes that breaking a solid takes at most; see the one for a mesh.
///   surface, inside  numbers of voxels
[[nodiscard]] std::uint64_t estimatedMemory(double surface, double inside);

/// The same of a solid, taken for a ball of its volume.
[[nodiscard]] std::uint64_t estimatedMemory(const Solid& solid);

/// estimatedMemory of a mesh.  With an automatic resolution that of the highest one, whose choice
/// takes as long as reading a mesh, unless that is above `enough`.
[[nodiscard]] std::uint64_t estimatedMemoryWithin(const TriangleMesh& mesh,
                                                  const FractureOptions& options, MeshesHeld held,
                                                  std::uint64_t enough);

}  // namespace sherd
