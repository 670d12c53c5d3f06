// Averages the middles of crossed edges.
#include "surface/exact/sheet_middles.h"

#include "interface/cells/cell.h"

namespace sherd {
namespace {

glm::dvec3 middleOf(const LeafCells& cells, const Cell& cell, std::uint32_t loop) {
  const auto hasPosition = [&](std::uint8_t other) {
    return other != CellSheets::kNone &&
           cells.positionIds[cell.firstLoop + other] == cells.positionIds[loop];
  };
  glm::dvec3 sum(0.0);
  double edges = 0.0;
  for (std::size_t e = 0; e < kCellEdges.size(); ++e) {
    if (!hasPosition(cell.loopOf[e][0]) && !hasPosition(cell.loopOf[e][1])) continue;
    for (const std::uint8_t corner : kCellEdges[e]) {
      sum += 0.5 * glm::dvec3(corner >> 2, (corner >> 1) & 1, corner & 1);
    }
    edges += 1.0;
  }
  return sum / edges;
}

}  // namespace

std::vector<glm::dvec3> middlesOf(const LeafCells& cells) {
  std::vector<glm::dvec3> middles(cells.vertices.size(), glm::dvec3(0.5));
  for (const Cell& cell : cells.cells) {
    if (cell.positions < 2) continue;
    for (std::uint32_t loop = cell.firstLoop; loop < cell.firstLoop + cell.loops; ++loop) {
      middles[loop] = middleOf(cells, cell, loop);
    }
  }
  return middles;
}

}  // namespace sherd
