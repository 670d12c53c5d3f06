// Where a cell's vertices lie.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>

#include "surface/cell.h"

namespace sherd {

/// What is known at the corners of a cell.
struct CellValues {
  CellLabels labels{};
  std::array<float, 8> toSurface{};  ///< distance to the solid's surface, any unit, inside negative
  std::array<std::array<float, 8>, 8> toCut{};  ///< [corner whose label][corner] voxels to the cut,
                                                ///< inside negative; read where two fragments meet
};

/// The place of a vertex, in 0..1 along each axis.
struct CellVertex {
  glm::dvec3 at{0.0};
  glm::dvec3 wanted{0.0};  ///< where it belongs; up to half a voxel beyond the cell on a rim, else
                           ///< `at`
};

/// One of a cell's vertices.
///   position  0..sheets.positions-1
///   stairs    [labels] how far a label keeps to its voxels' faces, 0..1
[[nodiscard]] CellVertex cellVertex(const CellValues& values, const CellSheets& sheets,
                                    unsigned position, std::span<const float> stairs);

}  // namespace sherd
