// Triangles that close a mesh.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// Returns the boundary loops of a mesh, of edges that are not used equally often in both
/// directions, each in the direction in which a triangle that closes it uses them.  A loop of one
/// hole passes each vertex once.
///   return  indices of vertices, 3 or more
[[nodiscard]] std::vector<std::vector<std::uint32_t>> openLoops(const TriangleMesh& mesh);

/// Returns triangles that close a mesh: with them every edge is used equally often in both
/// directions.  Their shape does not matter: the generalized winding number is that of the closed
/// mesh minus that of the caps.
///   return  with its own vertices, one boundary loop after another: consecutive vertices form an
///           edge of the boundary; empty for a closed mesh
[[nodiscard]] TriangleMesh loopCaps(const TriangleMesh& mesh);

/// Returns triangles from each edge that is used an odd number of times to the mean of all
/// vertices, as the paper's voxelizer closes a mesh; their orientation is arbitrary.
[[nodiscard]] TriangleMesh coneCaps(const TriangleMesh& mesh);

}  // namespace sherd
