// A face of a piece, among those of all pieces.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <glm/vec3.hpp>

namespace sherd {

/// Counter-clockwise seen from outside the piece.  A crack's face is there twice, once for each of
/// the pieces that it separates, with the same corners in reverse.
struct CleanFace {
  glm::uvec3 corner{0};
  std::uint16_t piece = 0;
  std::uint16_t other = 0;  ///< the piece, or other label, beyond it; 0: the outside
  std::uint32_t source = TriangleMesh::kNoSource;  ///< the triangle of the mesh that it is a part
                                                   ///< of; kNoSource: of a crack

  [[nodiscard]] bool isOutside() const { return source != TriangleMesh::kNoSource; }

  /// Of the two faces of a crack this is so for one.
  [[nodiscard]] bool isPrimary() const { return isOutside() || other > piece; }

  [[nodiscard]] bool has(std::uint32_t vertex) const {
    return corner.x == vertex || corner.y == vertex || corner.z == vertex;
  }
};

/// Returns corners with one vertex in place of another.
[[nodiscard]] inline glm::uvec3 replaced(glm::uvec3 corner, std::uint32_t from, std::uint32_t to) {
  for (int k = 0; k < 3; ++k) {
    if (corner[k] == from) corner[k] = to;
  }
  return corner;
}

}  // namespace sherd
