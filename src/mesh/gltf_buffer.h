// Buffers that a glTF file keeps in files of their own.
#pragma once

#include <string>
#include <string_view>

#include "mesh/mesh_reader.h"

namespace sherd {

/// The bytes of a buffer that a glTF file names, from the folder the file lies in.
///   uri     relative, may be percent-encoded; must not lead out of the folder
///   throws  Error(input) absent, unreadable, outside the folder
[[nodiscard]] std::string readGltfBuffer(const MeshFile& file, std::string_view uri);

/// "%20" and its like as the characters they stand for.
[[nodiscard]] std::string percentDecoded(std::string_view text);

}  // namespace sherd
