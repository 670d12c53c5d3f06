// How much memory a fracture takes, told before.
#pragma once

#include <sherd/fracture.h>
#include <sherd/mesh.h>

#include <cstdint>
#include <string>

namespace sherd {

/// How many fragments have their meshes in memory at once.
enum class MeshesHeld {
  all,
  some,      ///< as fractureInto does where WriteOptions::needsAllMeshes is false
  pictured,  ///< the same, and what WriteOptions::preview is made of
};

/// Bytes that breaking a mesh takes at most, the mesh and the files' bytes included: by the mesh's
/// area and volume in voxels, at rates measured on many fractures (docs/performance.md).  Within a
/// factor of two above what was seen.
[[nodiscard]] std::uint64_t estimatedMemory(const TriangleMesh& mesh,
                                            const FractureOptions& options,
                                            MeshesHeld held = MeshesHeld::all);

/// The same of a solid that is there already, or could be.
///   surface, inside  voxels
[[nodiscard]] std::uint64_t estimatedMemory(double surface, double inside);

/// Bytes that this process can still get: what the machine has free without swapping, and what
/// limits on the process (RLIMIT_AS) and its groups (cgroup v2, as Slurm and containers set them)
/// leave.
[[nodiscard]] std::uint64_t freeMemory();

/// Refuse what would not fit.
///   what    the sentence begins with it: "WHAT takes up to 3 GB of memory, ..."
///   throws  Error(usage) `bytes` are above `limit`
void requireMemory(const std::string& what, std::uint64_t bytes, std::uint64_t limit);

/// The same of breaking a mesh.
///   throws  Error(usage) the estimate is above `limit`, with the resolution that would fit, and
///           whether what is asked would if only some meshes were held; what voxelSizeFor throws.
///           An automatic resolution is found only where the highest one would not fit
void requireMemory(const TriangleMesh& mesh, const FractureOptions& options, std::uint64_t limit,
                   MeshesHeld held = MeshesHeld::all);

}  // namespace sherd
