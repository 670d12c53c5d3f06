// Reads a mesh from a file's bytes.
#pragma once

#include <sherd/mesh.h>

#include <filesystem>
#include <string>

namespace sherd {

/// What readMesh() does once it has a file's bytes.
///   path    its name tells the format; files that the mesh names are looked for beside it
///   throws  Error(input) as readMesh()
[[nodiscard]] SourceMesh meshFromBytes(const std::filesystem::path& path, std::string bytes,
                                       const ReadOptions& options = {},
                                       const Progress* progress = nullptr);

}  // namespace sherd
