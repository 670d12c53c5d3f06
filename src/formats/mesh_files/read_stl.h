// Reads STL files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Reads every triangle of a binary or text STL; each solid of a text is an object. A file is
/// binary if its size matches its count, even if its header begins with "solid". If the count is 0
/// or all ones, as streaming exporters leave it, the whole records are read, with a warning.
///   throws  Error(input) cut short, malformed, a size that does not fit its count
[[nodiscard]] RawMesh readStl(const MeshFile& file);

}  // namespace sherd
