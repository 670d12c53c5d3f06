// Other neighbors in a PLY file of a fragment, and nothing else.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace sherd {

/// Returns the bytes of a binary little-endian PLY with other values of the property `neighbor` of
/// its vertices and faces; all other bytes are the same.
///   ofVertex    [vertices of the file]
///   ofTriangle  [triangles of its faces, each a fan]
///   return      nothing if the file is not as writePiecePly writes it, or has other numbers of
///               vertices or triangles
[[nodiscard]] std::optional<std::string> withNeighbors(std::string ply,
                                                       std::span<const std::uint16_t> ofVertex,
                                                       std::span<const std::uint16_t> ofTriangle);

}  // namespace sherd
