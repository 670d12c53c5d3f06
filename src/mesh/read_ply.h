// Reads a PLY file with its look.
#pragma once

#include "mesh/mesh_reader.h"
#include "mesh/ply_body.h"

namespace sherd {

/// Whether a header announces colours or texture coordinates, of vertices or of faces.
[[nodiscard]] bool hasLook(const PlyHeader& header);

/// Every face of the file, with its look: `red green blue` of vertices and faces, texture
/// coordinates of vertices (`s t`, `u v` and their like) and of faces' corners (`list texcoord`,
/// with `texnumber`), and the textures of comments `TextureFile`.  Plain files are Assimp's, which
/// makes one texture coordinate of all that meet at a vertex.
///   file    passed checkComplete()
[[nodiscard]] RawMesh readPlyWithLook(const MeshFile& file);

}  // namespace sherd
