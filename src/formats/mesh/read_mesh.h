// Reads a mesh from a file's bytes.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <filesystem>
#include <string>

namespace sherd {

/// Reads a mesh from a file's bytes, as readMesh() does.
///   path    its extension selects the format; files that the mesh names are read from beside it
///   throws  Error(input) as readMesh()
[[nodiscard]] SourceMesh meshFromBytes(const std::filesystem::path& path, std::string bytes,
                                       const ReadOptions& options = {},
                                       const Progress* progress = nullptr);

}  // namespace sherd
