// A mesh of its own as a file, with the look that it was read with.
#pragma once

#include <sherd/mesh.h>
#include <sherd/mesh_files.h>

#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

/// Write a mesh.  A library of materials, named like the file, and textures are written beside
/// `.obj` and `.ply` files; where they are there already with other content, nothing is.
///   files   takes them by their paths
///   facing  [triangles], or empty
///   throws  Error(output)
void writeMeshFile(FileSink& files, const std::filesystem::path& file, const SourceMesh& source,
                   const std::vector<std::uint16_t>& facing, MeshFileFormat format);

/// What reading the file back would not give, a sentence for each thing.
[[nodiscard]] std::vector<std::string> lossesOf(const SourceMesh& source,
                                                const std::vector<std::uint16_t>& facing,
                                                MeshFileFormat format);

}  // namespace sherd
