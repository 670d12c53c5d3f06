// Turns a reader's result into a mesh.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>

#include "base/memory_budget.h"
#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Drops triangles with a corner that is not finite, merges exactly equal vertices (0 and -0 are
/// equal), drops triangles with two equal corners, then vertices that no triangle uses. The order
/// is kept. Sets all of the result except the file's name and hash. Linear in the number of
/// vertices.
///   memory  charged with SourceMesh::polygons where dropped triangles require them; may be null
[[nodiscard]] SourceMesh mergeVertices(RawMesh&& raw, MemoryBudget* memory = nullptr);

/// Returns the bytes that merging takes in addition to the mesh.
[[nodiscard]] std::uint64_t mergingMemory(const RawMesh& raw);

}  // namespace sherd
