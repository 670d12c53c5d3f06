// Voxels that are taken away so that bodies of a mesh stay apart.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "voxelize/fill.h"

namespace sherd {

/// What keeps bodies apart.
struct BodyGaps {
  std::vector<std::size_t> voxels{};  ///< inside voxels to be taken away, indices, ascending
  std::size_t joined = 0;             ///< pairs of bodies that stay joined, too thin for that
};

/// Returns inside voxels without which no voxel of one body has one of another body beside it.
///
/// Bodies are the closed components of a mesh, each with its cavities; those that overlap or touch
/// are one body.  Where two are closer than a voxel, their voxels are neighbors although nothing
/// connects them.  Of such a pair the voxel is taken away behind which its body has two others, of
/// two such the one nearer to its surface.  Bodies thinner than that beside each other stay joined.
///   blocks    of the solid, in the index space of `mesh`
///   mesh      closed, the result of repaired()
///   vertices  of the mesh, as they were given: whether bodies touch is decided with these, exactly
///   throws    Error(cancelled)
[[nodiscard]] BodyGaps bodyGapsOf(const LeafBlocks& blocks, const SearchedMesh& mesh,
                                  std::span<const glm::dvec3> vertices,
                                  const Progress* progress = nullptr);

}  // namespace sherd
