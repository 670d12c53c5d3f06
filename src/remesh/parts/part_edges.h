// Fragments that touch themselves along edges, parted there.
#pragma once

#include <sherd/progress.h>

#include <cstddef>
#include <string>
#include <vector>

#include "remesh/complex.h"

namespace sherd {

/// How far sheets that touch along an edge are parted, of the longest side of the box of all
/// meshes: programs that merge vertices within 1e-5 of its diagonal keep them apart.
inline constexpr double kPartedSheets = 3e-5;

/// Moves vertices of one sheet into the fragment where two sheets of its original surface touch
/// along an edge, so that merging equal positions leaves the mesh manifold.  Where that would let
/// faces cross, sheets move otherwise, and those that have only a vertex there may stay.  Vertices
/// of neighbors that share cracks there move along.  Positions that are not on such edges stay.
///   meshes   [fragments] closed and manifold, each sheet with vertices of its own
///   return   why it does not succeed, as a clause, or nothing; `meshes` are then to be discarded
///   throws   Error(cancelled)
[[nodiscard]] std::string partSheets(std::vector<LabeledMesh>& meshes,
                                     const Progress* progress = nullptr);

/// Returns the number of edges of the original surface that have more than two triangles, by
/// positions.
[[nodiscard]] std::size_t touchingEdges(const LabeledMesh& mesh);

}  // namespace sherd
