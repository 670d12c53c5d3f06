// Reads OBJ files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Every face of the file, with texture coordinates, vertex colours and materials.  What stands
/// behind an `o` is an object, or, in a file without one, what stands behind a `g`; those of one
/// name are one.
///   throws  Error(input) malformed, a vertex or texture coordinate that does not exist
[[nodiscard]] RawMesh readObj(const MeshFile& file);

}  // namespace sherd
