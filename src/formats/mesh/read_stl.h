// Reads STL files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Every triangle of a binary or text STL; each solid of a text is an object.  A binary file is one
/// whose size is what its count says, whatever its header begins with.  Where the count is nought
/// or all ones, as streaming exporters leave it, the whole records behind it are read, with a
/// warning.
///   throws  Error(input) cut short, malformed, a size that does not fit its count
[[nodiscard]] RawMesh readStl(const MeshFile& file);

}  // namespace sherd
