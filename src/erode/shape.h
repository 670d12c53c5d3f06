// The shapes that erosion tests, as rows of cells.
#pragma once

#include <sherd/erode.h>

#include <vector>

namespace sherd {

/// How far the largest shape reaches from its centre, in voxels.
inline constexpr int kLargestReach = 6;

/// The cells (x, y, -halfLength..halfLength) about the centre.
struct ShapeRow {
  int x = 0;
  int y = 0;
  int halfLength = 0;
};

/// Cells round a voxel; rows ascend by distance from the centre, where a voxel of the shell misses
/// cells first.
struct Shape {
  std::vector<ShapeRow> rows;
  int cells = 0;
};

/// The shape, or with `planes` its sections by x = 0, y = 0 and z = 0.
///   reach  (size - 1) / 2, 1..kLargestReach
[[nodiscard]] std::vector<Shape> shapesOf(ErodeShape shape, int reach, bool planes);

}  // namespace sherd
