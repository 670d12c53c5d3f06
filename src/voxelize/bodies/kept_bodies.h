// Bodies of a mesh that stay bodies of their own where they touch, overlap or lie within others.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include "voxelize/bodies/body_layers.h"

namespace sherd {

/// Returns the layers of bodies with MeetingBodies::keep: of closed components, each with its
/// cavities.  Bodies whose boxes come near each other are in different layers; a voxel within
/// several is that of the body with the least volume, of equal ones the first.
///   blocks  of the solid, in the index space of `mesh`
///   mesh    closed, the result of repaired(); bodies share no vertices
///   return  without bodies if there are fewer than two, or so many that they are joined
///   throws  Error(cancelled)
[[nodiscard]] BodyLayers keptLayers(const LeafBlocks& blocks, const SearchedMesh& mesh,
                                    const Progress* progress = nullptr);

}  // namespace sherd
