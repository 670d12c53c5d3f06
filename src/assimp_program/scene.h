// Reads a mesh by Assimp.  Only scene.cpp includes Assimp.
#pragma once

#include <string>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Every triangle of every node, with its look.  A texture without bytes is a file that the mesh
/// names; an absolute path, which is of the machine that wrote it, is told without its folders.
///   extension  "fbx", by which Assimp chooses its reader
///   throws     Error(input) what Assimp refuses, without the file's name
[[nodiscard]] RawMesh readScene(const std::string& bytes, const std::string& extension);

}  // namespace sherd
