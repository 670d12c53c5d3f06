// Reads a mesh from a file's bytes.
#pragma once

#include <sherd/files.h>
#include <sherd/fracture.h>
#include <sherd/mesh.h>

#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

/// Reads a mesh from a file's bytes, as readMesh() does.
///   path    its extension selects the format; files that the mesh names are read from beside it
///   throws  Error(input) as readMesh()
[[nodiscard]] SourceMesh meshFromBytes(const std::filesystem::path& path, std::string bytes,
                                       const ReadOptions& options = {},
                                       const Progress* progress = nullptr);

/// A mesh with a value at each vertex, neither merged nor with other attributes.
struct ValuedMesh {
  TriangleMesh mesh;          ///< triangles whose corners are finite, one at least
  std::vector<float> values;  ///< [vertices] as in the file, finite or not
};

/// Reads a mesh with an attribute of its vertices: a property of PLY, a channel of colors (`red`,
/// `green`, `blue`; in glTF also `alpha`), or an attribute of glTF that begins with an underscore.
///   throws  Error(input) as readMesh(); the file has no such attribute, and the sentence lists
///   those
///           that it has
[[nodiscard]] ValuedMesh readValuedMesh(const std::filesystem::path& path, const std::string& name,
                                        const ReadOptions& options = {},
                                        const Progress* progress = nullptr);

/// Reads a guide: the lines of OBJ and PLY files, and the triangles of all formats.
///   throws  Error(input) as readMesh(), of a file without both
[[nodiscard]] Guide guideFromBytes(const std::filesystem::path& path, std::string bytes,
                                   const ReadOptions& options = {},
                                   const Progress* progress = nullptr);

}  // namespace sherd
