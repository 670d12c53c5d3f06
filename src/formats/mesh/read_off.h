// Reads OFF files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Every face of a text OFF, with colours of vertices (COFF) or else of faces, and texture
/// coordinates (STOFF); normals (NOFF) are passed over.  A vertex and a face have a line each.
///   throws  Error(input) cut short, malformed, an index out of range, a binary OFF
[[nodiscard]] RawMesh readOff(const MeshFile& file);

}  // namespace sherd
