// Reads OBJ files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Reads every face, with texture coordinates, vertex colors and materials. A section after `o` is
/// an object, or, in a file without one, a section after `g`; those with one name are one object.
///   throws  Error(input) malformed, a vertex or texture coordinate that does not exist
[[nodiscard]] RawMesh readObj(const MeshFile& file);

}  // namespace sherd
