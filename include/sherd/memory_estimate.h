// How much memory a fracture takes, estimated before.
#pragma once

#include <sherd/fracture.h>
#include <sherd/memory.h>
#include <sherd/mesh.h>

#include <cstdint>

namespace sherd {

/// How many fragments have their meshes in memory at once.
enum class MeshesHeld {
  all,
  some,      ///< as fractureInto does where WriteOptions::needsAllMeshes is false
  pictured,  ///< the same, and what WriteOptions::preview is made of
};

/// Voxels along a solid's longest side that a preview shows at most: those of finer solids are
/// joined into so many cubes.
inline constexpr double kPreviewCubes = 768.0;

/// Bytes that breaking a mesh takes at most, the mesh and the files' bytes included: by the mesh's
/// area and volume in voxels, at rates measured on many fractures (docs/performance.md).  Within a
/// factor of two above what was seen.
[[nodiscard]] std::uint64_t estimatedMemory(const TriangleMesh& mesh,
                                            const FractureOptions& options,
                                            MeshesHeld held = MeshesHeld::all);

/// The same of a solid that is there already, or could be.
///   surface, inside  voxels
[[nodiscard]] std::uint64_t estimatedMemory(double surface, double inside);

/// Refuse to break a mesh that would not fit.
///   throws  Error(usage) the estimate is above `limit`, with the resolution that would fit, and
///           whether what is asked would if only some meshes were held; what voxelSizeFor throws.
///           An automatic resolution is found only where the highest one would not fit
void requireMemory(const TriangleMesh& mesh, const FractureOptions& options, std::uint64_t limit,
                   MeshesHeld held = MeshesHeld::all);

}  // namespace sherd
