// Reads the neighbor ids of the faces of a fragment's mesh.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

/// Returns the `neighbor` of each face in a binary little-endian `.ply`, as writePly() writes it;
/// other properties are allowed.
///   mesh    result of readMesh() for the file
///   return  [mesh.triangles], or empty: the file has none, or not for exactly these triangles
[[nodiscard]] std::vector<std::uint16_t> readNeighbors(const std::filesystem::path& file,
                                                       const TriangleMesh& mesh);

/// The same of a file's bytes.
[[nodiscard]] std::vector<std::uint16_t> neighborFromBytes(const std::string& bytes,
                                                           const TriangleMesh& mesh);

}  // namespace sherd
