// Estimates of the memory that a fracture takes.
#pragma once

#include <sherd/fracture.h>
#include <sherd/memory.h>
#include <sherd/mesh.h>

#include <cstdint>

namespace sherd {

/// Which fragments' meshes are in memory at once.
enum class MeshesHeld {
  all,
  some,     ///< a batch, as in fractureInto if WriteOptions::needsAllMeshes is false
  preview,  ///< a batch, and the coarse meshes of WriteOptions::preview
};

/// The most voxels along a solid's longest side that a preview shows; finer solids are coarsened to
/// this many.
inline constexpr double kPreviewCubes = 768.0;

/// Estimates the bytes that breaking a mesh takes at most, the mesh and the files' bytes included,
/// from the mesh's area and volume in voxels at rates measured on many fractures
/// (docs/history/memory.md).  The estimate is above the measured peak, by at most a factor of two.
[[nodiscard]] std::uint64_t estimatedMemory(const TriangleMesh& mesh,
                                            const FractureOptions& options,
                                            MeshesHeld held = MeshesHeld::all);

/// The same for a solid.
///   surface, inside  numbers of voxels
[[nodiscard]] std::uint64_t estimatedMemory(double surface, double inside);

/// Refuses to break a mesh that would not fit.  An automatic resolution is computed only if the
/// highest one would not fit.
///   throws  Error(usage) the estimate is above `limit`; the message names a resolution that fits,
///           and whether the requested one would fit with MeshesHeld::some; what voxelSizeFor
///           throws
void requireMemory(const TriangleMesh& mesh, const FractureOptions& options, std::uint64_t limit,
                   MeshesHeld held = MeshesHeld::all);

}  // namespace sherd
