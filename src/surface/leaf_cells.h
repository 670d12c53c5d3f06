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

#include "surface/cell.h"
#include "surface/contact_boundaries.h"
#include "surface/cut.h"
#include "surface/leaf_labels.h"
#include "voxelize/leaf_blocks.h"

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
  std::vector<std::uint32_t> positionIds;    ///< [loops] equal where they share a position
  std::uint32_t positionCount = 0;
  std::vector<std::uint32_t> nonManifold;  ///< positionIds at which a fragment has several vertices
  std::vector<Junction> junctions;         ///< vertices within the leaf
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

/// Labels and distances by voxel, over leaf blocks.
class Field {
 public:
  ///   neighborhoods  of the solid's leaves
  Field(const Solid& solid, const Labels& labels, const Cut& cut,
        std::span<const LeafNeighbors> neighborhoods)
      : solid_(solid), labels_(labels), cut_(cut), neighborhoods_(neighborhoods) {}

  /// Returns the index of the voxel at x, y, z from a leaf's lowest voxel, in that leaf or one of
  /// its 26 neighbors; kNoVoxel if there is no leaf.
  static constexpr std::size_t kNoVoxel = ~std::size_t{0};
  std::size_t voxelIndexNear(std::size_t leaf, int x, int y, int z) const {
    const auto k = static_cast<std::size_t>(((x >> 3) + 1) * 9 + ((y >> 3) + 1) * 3 + (z >> 3) + 1);
    const std::uint32_t other = neighborhoods_[leaf][k];
    return other == LeafBlocks::kNone ? kNoVoxel
                                      : std::size_t{other} * 512 + offsetFromCoord({x, y, z});
  }

  std::uint16_t label(std::size_t voxelIndex) const {
    return voxelIndex != kNoVoxel && solid_.blocks->isInside(voxelIndex)
               ? labels_.fragment[voxelIndex]
               : std::uint16_t{0};
  }

  /// Returns the labels at all corners of a leaf's cells.
  LabelCube<9> cornersOf(std::size_t leaf) const {
    return labelsAround<0, 1>(*solid_.blocks, labels_, neighborhoods_[leaf], Voxels::inside);
  }

  CellLabels labelsOf(std::size_t leaf, int x, int y, int z) const {
    CellLabels labels;
    for (int corner = 0; corner < 8; ++corner) {
      labels[static_cast<std::size_t>(corner)] =
          label(voxelIndexNear(leaf, x + (corner >> 2), y + ((corner >> 1) & 1), z + (corner & 1)));
    }
    return labels;
  }

  /// Distances to the cut of one label in one leaf, in voxels, negative inside its fragment.
  struct ToCut {
    const float* distance = nullptr;  ///< [512], or null where all are `everywhere`
    float everywhere = kHalfWidthVoxels;

    float at(std::size_t offset) const { return distance ? distance[offset] : everywhere; }
  };
  ToCut toCut(std::size_t leaf, std::uint16_t label) const {
    if (cut_.index[leaf] == Cut::kWhole) {
      return {nullptr, (cut_.only[leaf] == label ? -1.0f : 1.0f) * float{kHalfWidthVoxels}};
    }
    const CutLeaf& cells = cut_.leaves[cut_.index[leaf]];
    const auto at = std::lower_bound(cells.fragments.begin(), cells.fragments.end(), label);
    if (at == cells.fragments.end() || *at != label) return {};
    return {&cells.distance[static_cast<std::size_t>(at - cells.fragments.begin()) * 512]};
  }

  const Solid& solid() const { return solid_; }
  const Cut& cut() const { return cut_; }

 private:
  const Solid& solid_;
  const Labels& labels_;
  const Cut& cut_;
  std::span<const LeafNeighbors> neighborhoods_;
};

/// Returns the cells of a leaf.
///   intact  cells of the leaf in the intact solid, or null: cells with one label are reused
[[nodiscard]] LeafCells cellsOf(const Field& field, std::size_t leaf,
                                const LeafCells* intact = nullptr);

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
[[nodiscard]] std::vector<InterfaceQuad> quadsOf(const Field& field, const AllCells& all,
                                                 std::size_t leaf);

}  // namespace sherd
