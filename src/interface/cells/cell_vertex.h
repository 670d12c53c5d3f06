// Positions of the vertices of a cell.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "interface/cells/cell_crossings.h"

namespace sherd {

/// The position of a vertex, in 0..1 along each axis.
struct CellVertex {
  glm::dvec3 at{0.0};
  glm::dvec3 target{0.0};  ///< position to move to: on a contact boundary up to half a voxel
                           ///< outside the cell, or on a crease; else `at`
  std::uint8_t rank = 1;   ///< of the solid's surface: 2 on its creases, 3 at its corners
  glm::dvec3 normal{
      0.0};  ///< of the solid's plane at the target of a contact boundary, unit; else 0
};

/// Returns the position of one vertex of a cell.
///   position    0..sheets.positions-1
///   snapWeight  [labels] 0..1, 1 snaps the surface of a label to its voxels' faces
[[nodiscard]] CellVertex cellVertex(const CellValues& values, const CellSheets& sheets,
                                    unsigned position, std::span<const float> snapWeight);

}  // namespace sherd
