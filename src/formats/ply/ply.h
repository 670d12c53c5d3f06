// Writes PLY.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <string>

#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Writes binary little-endian PLY with one vertex for each of the mesh's, so it stays closed.
/// With PieceMesh::input its polygons are one face each where they are whole.
///   throws  Error(output)
void writePiecePly(const OutputFile& file, const PieceMesh& piece);

/// The same with vertices and triangles only.
void writePlainPly(const OutputFile& file, const TriangleMesh& mesh, bool isDouble = false);

}  // namespace sherd
