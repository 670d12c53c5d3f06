// A closed mesh cut by open surfaces, exactly.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include "intersect/mesh_cut.h"

namespace sherd {

/// Cuts a closed mesh and its cutters along their intersection.  What is connected to what is
/// decided exactly; as points are rounded, a part thinner than the rounding may be flipped.
///   surface  consistently oriented; vertices at one position are one vertex
///   cost     about surface triangles * log(cutters) + crossings * log(crossings)
///   throws   Error(cancelled)
[[nodiscard]] MeshCut cutMesh(const TriangleMesh& surface, const Cutters& cutters,
                              const Progress* progress = nullptr);

}  // namespace sherd
