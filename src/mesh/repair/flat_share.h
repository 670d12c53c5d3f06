// How much of a surface is flat.
#pragma once

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// Returns the share of a surface's area, 0..1, around which it is flat: all triangles nearer
/// than `reach` are parallel, up to a tenth of a degree.  So no part of a ball is flat
/// whose triangles are smaller than that, with a radius below 500 times `reach`, and of the surface
/// of a box what is farther from its edges.
///   cost  the number of triangles, and a thousand queries
[[nodiscard]] double flatShare(const TriangleTree& tree, double reach);

}  // namespace sherd
