// Writes a mesh that is no fragment, with its appearance.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

/// Writes a mesh. A library of materials, named like the file, and textures are written beside
/// `.obj` and `.ply` files.
///   files   receives the files by path
///   throws  Error(output), also if a library or texture exists with other content
void writeMeshFile(FileSink& files, const std::filesystem::path& file, const SourceMesh& source,
                   MeshFileFormat format);

/// Returns what is lost if the file is read back, one sentence per loss.
[[nodiscard]] std::vector<std::string> lossesOf(const SourceMesh& source, MeshFileFormat format);

}  // namespace sherd
