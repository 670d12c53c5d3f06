// The cells of one leaf that surfaces pass through, with their vertices and faces.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surface/cell.h"
#include "surface/cut.h"
#include "surface/leaf_labels.h"
#include "surface/rims.h"

namespace sherd {

/// A cell that a surface passes through, by its lowest corner; what its sheets are, as far as quads
/// need it.  There are as many of them as vertices.
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
  std::array<std::uint64_t, 8> passed{};     ///< [offset / 64] bit offset % 64: is there a cell?
  std::array<std::uint16_t, 8> firstCell{};  ///< of each of these words
  std::vector<glm::dvec3> vertices;          ///< [loops] index space
  std::vector<std::uint32_t> places;         ///< [loops] equal where they share a position
  std::uint32_t placeCount = 0;
  std::vector<std::uint32_t> crowded;  ///< places where a fragment has several vertices
  std::vector<Junction> junctions;     ///< vertices within the leaf
  bool isPlain = true;  ///< no place is crowded, and no label lies on two opposite corners of a
                        ///< face only: then no cell depends on its neighbours

  /// The cell of an offset that a surface passes through.
  const Cell& at(std::size_t offset) const {
    const std::uint64_t before = (std::uint64_t{1} << (offset % 64)) - 1;
    const auto rank = static_cast<std::size_t>(std::popcount(passed[offset / 64] & before));
    return cells[firstCell[offset / 64] + rank];
  }

  /// Add one, of a higher offset than all others.
  void add(const Cell& cell) {
    const std::size_t word = cell.offset / 64u;
    if (passed[word] == 0) firstCell[word] = static_cast<std::uint16_t>(cells.size());
    passed[word] |= std::uint64_t{1} << (cell.offset % 64u);
    cells.push_back(cell);
  }
};

/// Labels and distances by voxel, over leaf blocks.
class Field {
 public:
  ///   rounds  of the solid's leaves
  Field(const Solid& solid, const Labels& labels, const Cut& cut, std::span<const LeafRound> rounds)
      : solid_(solid), labels_(labels), cut_(cut), rounds_(rounds) {}

  /// The place of a voxel up to a leaf away from a leaf's own, x, y, z counted from its lowest; or
  /// kNowhere.
  static constexpr std::size_t kNowhere = ~std::size_t{0};
  std::size_t placeNear(std::size_t leaf, int x, int y, int z) const {
    const auto k = static_cast<std::size_t>(((x >> 3) + 1) * 9 + ((y >> 3) + 1) * 3 + (z >> 3) + 1);
    const std::uint32_t other = rounds_[leaf][k];
    return other == LeafBlocks::kNone ? kNowhere
                                      : std::size_t{other} * 512 + offsetFromCoord({x, y, z});
  }

  std::uint16_t label(std::size_t place) const {
    return place != kNowhere && solid_.blocks.isInside(place) ? labels_.fragment[place]
                                                              : std::uint16_t{0};
  }

  /// The labels at all corners of a leaf's cells.
  LabelCube<9> cornersOf(std::size_t leaf) const {
    return labelsRound<0, 1>(solid_.blocks, labels_, rounds_[leaf], Voxels::inside);
  }

  CellLabels labelsOf(std::size_t leaf, int x, int y, int z) const {
    CellLabels labels;
    for (int corner = 0; corner < 8; ++corner) {
      labels[static_cast<std::size_t>(corner)] =
          label(placeNear(leaf, x + (corner >> 2), y + ((corner >> 1) & 1), z + (corner & 1)));
    }
    return labels;
  }

  /// Voxels to the cut, negative inside the label's fragment.
  float toCut(std::size_t place, std::uint16_t label) const {
    if (place == kNowhere) return kHalfWidthVoxels;
    const std::size_t leaf = place / 512;
    if (cut_.index[leaf] == Cut::kWhole) {
      return cut_.only[leaf] == label ? -float{kHalfWidthVoxels} : float{kHalfWidthVoxels};
    }
    const CutLeaf& cells = cut_.leaves[cut_.index[leaf]];
    const auto at = std::lower_bound(cells.fragments.begin(), cells.fragments.end(), label);
    if (at == cells.fragments.end() || *at != label) return kHalfWidthVoxels;
    return cells
        .distance[static_cast<std::size_t>(at - cells.fragments.begin()) * 512 + place % 512];
  }

  const Solid& solid() const { return solid_; }
  const Cut& cut() const { return cut_; }

 private:
  const Solid& solid_;
  const Labels& labels_;
  const Cut& cut_;
  std::span<const LeafRound> rounds_;
};

/// The cells of a leaf.
///   unbroken  the same leaf's where the solid is one fragment, or null: cells that have one label
///             are as they are there
[[nodiscard]] LeafCells cellsOf(const Field& field, std::size_t leaf,
                                const LeafCells* unbroken = nullptr);

/// The only label but 0 at the corners of a leaf's cells; 0 where there is none, nothing where
/// there are several.
[[nodiscard]] std::optional<std::uint16_t> onlyLabelOf(const Field& field, std::size_t leaf);

/// The cells of all leaves, and where their vertices begin in the whole mesh.
struct AllCells {
  std::vector<const LeafCells*> leaves;
  std::vector<std::uint32_t> firstVertex;
};

/// The quads about the edges that begin at the lowest corner of the leaf's cells, but those about
/// which leaves are missing: that happens only where a part of a solid is meshed, off what it is
/// meshed for.
[[nodiscard]] std::vector<InterfaceQuad> quadsOf(const Field& field, const AllCells& all,
                                                 std::size_t leaf);

}  // namespace sherd
