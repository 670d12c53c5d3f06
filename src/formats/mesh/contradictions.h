// Checks that a reader's result is consistent.
#pragma once

#include <optional>
#include <string>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Returns the first violation of RawMesh's invariants: an index out of range, an array whose
/// length is not the number of triangles, a texture coordinate that is not finite; nothing if there
/// is none. Linear in the mesh.
[[nodiscard]] std::optional<std::string> contradictionIn(const RawMesh& mesh);

}  // namespace sherd
