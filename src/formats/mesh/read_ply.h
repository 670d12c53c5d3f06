// Reads PLY files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Every face and triangle strip of the file, ASCII or binary in both orders, with its look: `red
/// green blue` of vertices and faces, texture coordinates of vertices (`s t`, `u v` and their like)
/// and of faces' corners (`list texcoord`, with `texnumber`), and materials as comments name them.
///   throws  Error(input) cut short, malformed, an index out of range, points without faces
[[nodiscard]] RawMesh readPly(const MeshFile& file);

}  // namespace sherd
