// Files that a mesh file names: only those in or below its folder are read.
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
  std::string refusal;  ///< why it must not be opened, to follow its name in a sentence;
                        ///< empty: it may be opened if it exists
};

/// Resolves a name. It may be opened if it is relative and leads into the mesh's folder or below
/// it, symbolic links followed, the same rule as for manifests. A backslash separates folders, too.
[[nodiscard]] NamedFile fileBeside(const MeshFile& file, std::string_view name);

/// Returns the bytes of a file that a mesh names. If it cannot be read, adds a sentence to
/// `warnings` that states why, and what is lost.
///   kind  its kind in that sentence: "texture"
[[nodiscard]] std::optional<std::string> readBeside(const MeshFile& file, std::string_view name,
                                                    const std::string& kind,
                                                    std::vector<std::string>& warnings);

/// Returns the index in `mesh` of the texture with that name, which is read once; -1 if it cannot
/// be read.
[[nodiscard]] int textureBeside(const MeshFile& file, std::string_view name, RawMesh& mesh);

/// Returns whether a PNG or JPEG has one color channel.
[[nodiscard]] bool isGrayImage(std::string_view bytes);

}  // namespace sherd
