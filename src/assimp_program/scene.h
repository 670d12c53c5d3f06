// Reads a mesh by Assimp.  Only scene.cpp includes Assimp.
#pragma once

#include <string>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Returns every triangle of every node, with its attributes. A texture without bytes is a file
/// that the mesh names; an absolute path, which belongs to the machine that wrote it, is reduced to
/// its file name.
///   extension  "fbx" or "dae": selects Assimp's reader
///   throws     Error(input) a file that Assimp refuses; the message does not name the file
[[nodiscard]] RawMesh readScene(const std::string& bytes, const std::string& extension);

}  // namespace sherd
