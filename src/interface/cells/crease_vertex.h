// Vertices at creases of the input.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "interface/cells/cell.h"

namespace sherd {

/// The vertex of a cell in which the distances are not those to one plane.
struct CreaseVertex {
  std::uint16_t offset = 0;  ///< of the cell in its leaf
  std::uint16_t edges = 0;   ///< bits of the cell's edges whose crossings it is of
  std::uint8_t rank = 1;     ///< 1 on a smooth part of the input, 2 on a crease, 3 at a corner
  bool isForced = false;     ///< its planes do not meet in the cell, or not on the input, as where
                             ///< creases are less than a voxel apart, or at a small angle; its
                             ///< triangles are checked
  glm::dvec3 at{0.0};        ///< 0..1 along each axis in the cell, up to kMostOutside beyond it
  glm::dvec3 inCell{0.0};    ///< the same within the cell
};

/// Returns bits of the edges of a position.
[[nodiscard]] inline std::uint16_t edgesOf(const CellSheets& sheets, unsigned position) {
  unsigned edges = 0;
  for (unsigned e = 0; e < 12; ++e) {
    if (sheets.positionOf[e] == position) edges |= 1u << e;
  }
  return static_cast<std::uint16_t>(edges);
}

}  // namespace sherd
