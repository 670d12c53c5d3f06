// Reads a mesh by Assimp.
#pragma once

#include "mesh/mesh_reader.h"

namespace sherd {

/// Every triangle of every node of the file.  Buffers that a .gltf names are read from the folder
/// it lies in.
///   file    passed checkComplete(): Assimp 5.2.5 ends the process on some malformed files
///   throws  Error(input) what Assimp refuses, a buffer that is missing, an index without a vertex
[[nodiscard]] RawMesh readWithAssimp(const MeshFile& file);

}  // namespace sherd
