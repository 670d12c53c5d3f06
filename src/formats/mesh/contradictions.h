// Whether what a reader found holds together.
#pragma once

#include <optional>
#include <string>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// What is against RawMesh's promises: an index out of range, an array of another length than the
/// triangles, a texture coordinate that is not finite; none where they hold.  Linear in the mesh.
[[nodiscard]] std::optional<std::string> contradictionIn(const RawMesh& mesh);

}  // namespace sherd
