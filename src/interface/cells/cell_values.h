// Reads the cells of a field.
#pragma once

#include <array>

#include "interface/cells/cell_crossings.h"
#include "interface/cells/field.h"
#include "interface/cells/input_crossings.h"

namespace sherd {

/// Returns the labels at the corners of a cell.
///   corners  Field::cornersOf the leaf
///   cell     its lowest corner, from the leaf's lowest voxel
[[nodiscard]] CellLabels labelsAt(const LabelCube<9>& corners, const openvdb::Coord& cell);

/// The sheets of a cell, with ambiguous faces resolved alike on both sides.
struct ResolvedSheets {
  CellSheets sheets;
  bool dependsOnNeighbors = false;  ///< on their labels
};
[[nodiscard]] ResolvedSheets resolvedSheets(const Field& field, std::size_t leaf,
                                            const openvdb::Coord& cell, const CellLabels& labels);

/// Distances to the solid's surface at the corners of a leaf's cells, as Field::cornersOf.
using DistanceCube = std::array<float, 9 * 9 * 9>;
[[nodiscard]] DistanceCube distancesOf(const Field& field, std::size_t leaf);

/// Returns those at the corners of one cell.
[[nodiscard]] std::array<float, 8> distancesAt(const DistanceCube& distance,
                                               const openvdb::Coord& cell);

/// Returns the step from the lowest corner of a cell to another.
[[nodiscard]] inline openvdb::Coord coordOfCorner(unsigned corner) {
  return {static_cast<int>(corner >> 2), static_cast<int>((corner >> 1) & 1),
          static_cast<int>(corner & 1)};
}

/// Returns the distances at the corners of a cell, without the input's crossings.
///   distance  of its leaf
[[nodiscard]] CellValues valuesOf(const Field& field, const DistanceCube& distance,
                                  std::size_t leaf, const openvdb::Coord& cell,
                                  const CellLabels& labels);

/// Sets the input's crossings of a cell that the solid's surface passes, where they may differ from
/// those of the distances.
void addInput(InputCrossings& input, const openvdb::Coord& cell, const CellSheets& sheets,
              CellValues& values);

}  // namespace sherd
