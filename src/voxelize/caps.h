// Closing a mesh.
#pragma once

#include <sherd/mesh.h>

namespace sherd {

/// Triangles that close a mesh: with them every edge is used as often in one direction as in the
/// other.  They need not lie well: a generalised winding number is the closed mesh's less theirs,
/// wherever they lie.
///   return  with vertices of its own, a loop of the boundary after another: two that follow each
///           other are an edge of the boundary; empty for a closed mesh
[[nodiscard]] TriangleMesh loopCaps(const TriangleMesh& mesh);

/// Triangles from each edge that is used an odd number of times to the mean of all vertices, as
/// the paper's voxeliser closes a mesh without looking; they turn any way.
[[nodiscard]] TriangleMesh coneCaps(const TriangleMesh& mesh);

}  // namespace sherd
