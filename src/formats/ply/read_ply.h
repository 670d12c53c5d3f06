// Reads PLY files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Reads every face and triangle strip, ASCII or binary in both byte orders, with attributes: `red
/// green blue` of vertices and faces, texture coordinates of vertices (`s t`, `u v` and their
/// variants) and of faces' corners (`list texcoord`, with `texnumber`), and materials that comments
/// name.
///   throws  Error(input) cut short, malformed, an index out of range, points without faces
[[nodiscard]] RawMesh readPly(const MeshFile& file);

}  // namespace sherd
