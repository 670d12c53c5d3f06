// The surface of the unbroken solid, which most of its fragments' surface is.
#pragma once

#include <sherd/solid.h>

#include <array>
#include <cstdint>
#include <vector>

#include "surface/leaf_cells.h"

namespace sherd {

/// What a leaf has of the unbroken solid's mesh.
struct UnbrokenLeaf {
  /// A corner of a triangle: a vertex of the leaf, or of one below it along some axes, in the three
  /// highest bits: x 4, y 2, z 1.
  static constexpr unsigned kSlotBits = 29;
  using Corner = std::uint32_t;

  LeafCells cells;
  std::vector<std::array<Corner, 3>> triangles;
  bool isWhole = false;  ///< it and those below are plain, so that the triangles hold wherever all
                         ///< of these have one label
};

/// Made once for a solid that is broken many times.  Some 0.5 kB a leaf and 260 bytes for each cell
/// that the surface passes.
struct UnbrokenSurface {
  std::vector<LeafRound> rounds;  ///< of the solid's leaves
  std::vector<UnbrokenLeaf> leaves;
};

}  // namespace sherd
