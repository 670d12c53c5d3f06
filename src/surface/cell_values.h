// Reads the cells of a field.
#pragma once

#include <openvdb/openvdb.h>

#include "surface/cell_crossings.h"
#include "surface/field.h"
#include "surface/input_crossings.h"

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

/// Returns the distances at the corners of a cell, without the input's crossings.
[[nodiscard]] CellValues valuesOf(const Field& field,
                                  const openvdb::FloatGrid::ConstAccessor& distance,
                                  std::size_t leaf, const openvdb::Coord& cell,
                                  const CellLabels& labels);

/// Sets the input's crossings of a cell that the solid's surface passes, where they may differ from
/// those of the distances.
void addInput(InputCrossings& input, const openvdb::Coord& cell, const CellSheets& sheets,
              CellValues& values);

}  // namespace sherd
