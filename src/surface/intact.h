// The surface of the intact solid, which its fragments reuse.
#pragma once

#include <sherd/solid.h>

#include <array>
#include <cstdint>
#include <vector>

#include "surface/leaf_cells.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {

/// The part of the intact solid's mesh that belongs to one leaf.
struct IntactLeaf {
  /// A corner of a triangle: the index of a vertex of the leaf, or of a leaf below it along the
  /// axes in the three highest bits: x 4, y 2, z 1.
  static constexpr unsigned kSlotBits = 29;
  using Corner = std::uint32_t;

  LeafCells cells;
  std::vector<std::array<Corner, 3>> triangles;
  bool isWhole = false;  ///< the leaf and those below it are plain, so that the triangles are valid
                         ///< if all of these have one label
};

/// The intact surface, computed once for a solid that is fractured several times.  About 0.5 kB per
/// leaf and 260 bytes per cell that the surface passes through.
struct IntactSurface {
  std::vector<LeafNeighbors> neighborhoods;  ///< of the solid's leaves
  std::vector<IntactLeaf> leaves;
};

}  // namespace sherd
