// What the faces of a fragment's mesh face, read back.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

/// The `facing` of each face in a binary little-endian `.ply`, as writePly makes it; other
/// properties may stand beside.
///   mesh    what readMesh made of the file
///   return  [mesh.triangles], or empty: the file has none, or not for just these triangles
[[nodiscard]] std::vector<std::uint16_t> readFacing(const std::filesystem::path& file,
                                                    const TriangleMesh& mesh);

/// The same of a file's bytes.
[[nodiscard]] std::vector<std::uint16_t> facingFromBytes(const std::string& bytes,
                                                         const TriangleMesh& mesh);

}  // namespace sherd
