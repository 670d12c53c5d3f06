// Positions of the vertices of a cell.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>

#include "surface/cell.h"

namespace sherd {

/// Labels and distances at the corners of a cell.
struct CellValues {
  CellLabels labels{};
  std::array<float, 8> toSurface{};  ///< distance to the solid's surface, any unit, inside
                                     ///< negative; set where a label is 0
  std::array<std::array<float, 8>, 8> toCut{};  ///< [corner whose label][corner] voxels to the cut,
                                                ///< inside negative; set where two fragments meet
};

/// The position of a vertex, in 0..1 along each axis.
struct CellVertex {
  glm::dvec3 at{0.0};
  glm::dvec3 target{0.0};  ///< position to move to: on a contact boundary up to half a voxel
                           ///< outside the cell, else `at`
};

/// Returns the position of one vertex of a cell.
///   position    0..sheets.positions-1
///   snapWeight  [labels] 0..1, 1 snaps the surface of a label to its voxels' faces
[[nodiscard]] CellVertex cellVertex(const CellValues& values, const CellSheets& sheets,
                                    unsigned position, std::span<const float> snapWeight);

}  // namespace sherd
