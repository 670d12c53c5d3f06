// Triangles that cross each other in a file of single precision.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstddef>

namespace sherd {

/// Returns the number of pairs of triangles that cross each other once all vertices are rounded to
/// single precision, and do not before.  Of a mesh with neighbors only pairs count of which one
/// ends where a crack meets the original surface: there cuts leave slivers, and all others would
/// cost more than the cut.  Vertices at one position count as one, triangles with two equal corners
/// as none.
///   throws  Error(cancelled)
[[nodiscard]] std::size_t roundedCrossings(const TriangleMesh& mesh,
                                           const Progress* progress = nullptr);

}  // namespace sherd
