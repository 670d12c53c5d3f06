// Files that a mesh file names: what lies beside it may be read, nothing else.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// A file that a mesh file names.
struct NamedFile {
  std::filesystem::path path;
  std::string refusal;  ///< why it must not be opened, as what follows its name in a sentence;
                        ///< empty: it may be, if it is there
};

/// It may be opened if its name is relative and leads to something in the mesh's folder or below
/// it, symbolic links followed: the rule that manifests have.  A backslash parts folders, too.
[[nodiscard]] NamedFile fileBeside(const MeshFile& file, std::string_view name);

/// The bytes of a file that a mesh names.  Where it cannot be had, `warnings` gains a sentence that
/// tells why and what is lost.
///   kind  what it is, for the sentence: "texture"
[[nodiscard]] std::optional<std::string> readBeside(const MeshFile& file, std::string_view name,
                                                    const std::string& kind,
                                                    std::vector<std::string>& warnings);

/// The number of the texture of that name among the mesh's, read once; -1 where it cannot be had.
[[nodiscard]] int textureBeside(const MeshFile& file, std::string_view name, RawMesh& mesh);

}  // namespace sherd
