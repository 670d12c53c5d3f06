// Writes a mesh in any format.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <string>

#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Returns whether vertices can be written in double precision.
[[nodiscard]] inline bool holdsDoubles(MeshFileFormat format) {
  return format == MeshFileFormat::ply || format == MeshFileFormat::obj ||
         format == MeshFileFormat::stlText;
}

/// Writes a mesh in a format, by the function of it.
///   library  of materials, for OBJ; see writePieceObj
///   throws   Error(output)
void writePiece(const OutputFile& file, MeshFileFormat format, const PieceMesh& piece,
                const std::string& library);

}  // namespace sherd
