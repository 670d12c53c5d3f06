// From what a reader found to a mesh.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Drop triangles with a corner that is not finite, make exactly equal vertices one (0 and -0 are
/// equal), drop triangles with two equal corners, then vertices that no triangle uses.  What is
/// left keeps its order, and is told of all but the file.  Linear in the number of vertices.
[[nodiscard]] SourceMesh mergeVertices(RawMesh&& raw);

/// Bytes that merging takes beside the mesh itself.
[[nodiscard]] std::uint64_t mergingMemory(const RawMesh& raw);

}  // namespace sherd
