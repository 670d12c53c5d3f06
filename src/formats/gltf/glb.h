// Writes binary glTF.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <string>

#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Writes binary glTF 2.0 with embedded PNG and JPEG textures: one node with one mesh, see
/// addGlbMesh, below one that converts coordinates to glTF's where they are not.
///   throws  Error(output)
void writePieceGlb(const OutputFile& file, const PieceMesh& piece);

/// The same with vertices and triangles only.
void writePlainGlb(const OutputFile& file, const std::string& name, const TriangleMesh& mesh,
                   const CoordinateSystem& coordinates);

}  // namespace sherd
