// The structuring elements of erosion, as rows of cells.
#pragma once

#include <sherd/labels.h>

#include <vector>

namespace sherd {

/// The reach of the largest shape from its center, in voxels.
inline constexpr int kLargestReach = 6;

/// The cells (x, y, -halfLength..halfLength) relative to the center.
struct ShapeRow {
  int x = 0;
  int y = 0;
  int halfLength = 0;
};

/// Cells around a voxel; rows ascend by distance from the center, because the empty cells of a
/// shell voxel are most often near it.
struct Shape {
  std::vector<ShapeRow> rows;
  int cells = 0;
};

/// Returns the shape, or with `planes` its sections by x = 0, y = 0 and z = 0.
///   reach  (size - 1) / 2, 1..kLargestReach
[[nodiscard]] std::vector<Shape> shapesOf(ErodeShape shape, int reach, bool planes);

}  // namespace sherd
