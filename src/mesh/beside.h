// Files that a mesh file names: what lies beside it may be read, nothing else.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "mesh/mesh_reader.h"

namespace sherd {

/// The path of a file that a mesh file names, if it is relative and does not lead out of the mesh's
/// folder.  A backslash parts folders, too.
[[nodiscard]] std::optional<std::filesystem::path> pathBeside(const MeshFile& file,
                                                              std::string_view name);

/// The bytes of a file that a mesh names.  Where it cannot be had, `warnings` gains a sentence that
/// tells why and what is lost.
///   kind  what it is, for the sentence: "texture"
[[nodiscard]] std::optional<std::string> readBeside(const MeshFile& file, std::string_view name,
                                                    const std::string& kind,
                                                    std::vector<std::string>& warnings);

/// The number of the texture of that name among the mesh's, read once; -1 where it cannot be had.
[[nodiscard]] int textureBeside(const MeshFile& file, std::string_view name, RawMesh& mesh);

}  // namespace sherd
