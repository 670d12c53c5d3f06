// Level sets of several solids as one grid.
#pragma once

#include <sherd/solid.h>

#include <span>

namespace sherd {

struct PlacedGrid {
  ConstFloatGridPtr grid;
  int shift = 0;  ///< voxels along x, a multiple of 8
};

/// Returns the leaf nodes of all grids in one, filled inside.
///   grids  narrow bands of one background, whose leaf nodes do not meet
///   like   whose transform it has
[[nodiscard]] ConstFloatGridPtr composedGrid(std::span<const PlacedGrid> grids,
                                             const ConstFloatGridPtr& like);

}  // namespace sherd
