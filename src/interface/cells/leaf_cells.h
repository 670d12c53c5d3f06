// The cells of one leaf that surfaces pass through, their vertices and quads.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "interface/cells/cell.h"
#include "interface/cells/cell_set.h"
#include "interface/cells/contact_boundaries.h"
#include "interface/cells/field.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// A cell that a surface passes through, by its lowest corner, with the part of its CellSheets that
/// quads need.  Compact, because there are as many cells as vertices.
struct Cell {
  std::uint16_t offset = 0;
  std::uint8_t loops = 0, positions = 0;  ///< CellSheets::loops, positions
  std::uint32_t firstLoop = 0;            ///< within the leaf
  decltype(CellSheets::loopOf) loopOf{};  ///< CellSheets::loopOf

  [[nodiscard]] bool isCrossed(std::size_t edge) const {
    return loopOf[edge][0] != CellSheets::kNone || loopOf[edge][1] != CellSheets::kNone;
  }
};

/// The cells of a leaf, and their vertices.
struct LeafCells {
  std::vector<Cell> cells;                   ///< by offset, ascending
  std::array<std::uint64_t, 8> passed{};     ///< [offset / 64] bit offset % 64: a cell exists
  std::array<std::uint16_t, 8> firstCell{};  ///< index of the first cell of each word
  std::vector<glm::dvec3> vertices;          ///< [loops] index space
  std::vector<std::uint16_t> labels;         ///< [loops] whose surface it is
  std::vector<std::uint8_t> ranks;           ///< [loops] CellVertex::rank
  std::vector<std::uint32_t> positionIds;    ///< [loops] equal where they share a position
  std::uint32_t positionCount = 0;
  std::vector<std::uint32_t> nonManifold;  ///< positionIds at which a fragment has several vertices
  std::vector<Junction> junctions;         ///< vertices within the leaf
  CellBits made{};                         ///< cells that are not the intact solid's
  std::vector<std::uint16_t> fromIntact;   ///< [vertices of the leaf in the intact solid] index of
                                           ///< each, or kNotIntact; empty without intact cells
  static constexpr std::uint16_t kNotIntact = 0xffff;
  bool isPlain = true;  ///< no position is non-manifold and no face conflicting, so that no cell
                        ///< depends on its neighbors

  /// Returns the cell at an offset that a surface passes through.
  const Cell& at(std::size_t offset) const {
    const std::uint64_t before = (std::uint64_t{1} << (offset % 64)) - 1;
    const auto rank = static_cast<std::size_t>(std::popcount(passed[offset / 64] & before));
    return cells[firstCell[offset / 64] + rank];
  }

  /// Appends a cell.  Its offset must be higher than all others.
  void add(const Cell& cell) {
    const std::size_t word = cell.offset / 64u;
    if (passed[word] == 0) firstCell[word] = static_cast<std::uint16_t>(cells.size());
    passed[word] |= std::uint64_t{1} << (cell.offset % 64u);
    cells.push_back(cell);
  }
};

/// Returns the cells of a leaf.
///   intact  cells of the leaf in the intact solid, or null: cells with one label are reused
///   only    the cells that are wanted, or null: all
[[nodiscard]] LeafCells cellsOf(const Field& field, std::size_t leaf,
                                const LeafCells* intact = nullptr, const CellBits* only = nullptr);

/// Returns the only label other than 0 at the corners of a leaf's cells; 0 if there is none,
/// nullopt if there are several.
[[nodiscard]] std::optional<std::uint16_t> onlyLabelOf(const Field& field, std::size_t leaf);

/// The cells of all leaves, and the index of each leaf's first vertex in the whole mesh.
struct AllCells {
  std::vector<const LeafCells*> leaves;
  std::vector<std::uint32_t> firstVertex;
};

/// Returns the quads around the edges that begin at the lowest corners of the leaf's cells.  Edges
/// with a missing leaf next to them have no quad; that happens only when part of a solid is meshed,
/// away from the fragment in question.
///   edges  only those of the quads, or null: all; cells that are not around them may be missing in
///          `all`
///   return ascending by edge
[[nodiscard]] std::vector<InterfaceQuad> quadsOf(const Field& field, const AllCells& all,
                                                 std::size_t leaf,
                                                 const LeafEdges* edges = nullptr);

}  // namespace sherd
