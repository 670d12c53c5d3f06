// Reads an OBJ file with its look.
#pragma once

#include "mesh/mesh_reader.h"

namespace sherd {

/// Every face of the file, with texture coordinates, vertex colours and materials.  Plain files are
/// Assimp's; it loses colours that not all vertices have, and reads hostile libraries beyond their
/// end.
///   file    passed checkComplete()
///   throws  Error(input) a texture coordinate that does not exist
[[nodiscard]] RawMesh readObjWithLook(const MeshFile& file);

}  // namespace sherd
