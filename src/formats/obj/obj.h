// Writes OBJ.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <string>

#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Writes OBJ with normals, and with texture coordinates and colors if present.  With
/// PieceMesh::input its polygons are one face each where they are whole, and its objects are
/// groups, beside a group "inside".
///   library  the file of mtlText(piece.materials), beside it; empty: no materials are named
///   throws   Error(output)
void writePieceObj(const OutputFile& file, const PieceMesh& piece, const std::string& library);

/// The same with vertices and triangles only.
void writePlainObj(const OutputFile& file, const TriangleMesh& mesh, bool isDouble = false);

}  // namespace sherd
