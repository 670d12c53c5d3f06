// Reads OFF files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Reads every face of a text OFF, with colors of vertices (COFF) or else of faces, and texture
/// coordinates (STOFF); normals (NOFF) are skipped. Each vertex and each face is a line.
///   throws  Error(input) cut short, malformed, an index out of range, a binary OFF
[[nodiscard]] RawMesh readOff(const MeshFile& file);

}  // namespace sherd
