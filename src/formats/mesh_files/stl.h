// Writes STL.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <string>

#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Writes binary STL: triangles with their normals only.
///   throws  Error(output)
void writePieceStl(const OutputFile& file, const PieceMesh& piece);

/// Writes text STL.
///   throws  Error(output)
void writePieceStlText(const OutputFile& file, const PieceMesh& piece);

}  // namespace sherd
