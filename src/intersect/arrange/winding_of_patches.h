// Winding numbers beside the parts of an arrangement.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <optional>
#include <span>
#include <vector>

#include "intersect/arrange/arrangement.h"
#include "intersect/arrange/point_set.h"
#include "mesh/search/triangle_tree.h"

namespace sherd {

/// Returns the winding number of a closed mesh in front of each part; behind it the number is
/// greater by its multiplicity.  It is the same all over a patch: parts connected over edges that
/// two parts have.  One part of each patch is decided exactly: of a line along an axis through a
/// point inside the part, the triangles that it meets beyond the point are counted by their
/// orientation.  A line that meets an edge is replaced by that of another point.
///   mesh    closed; its triangles all have an area
///   tree    of `mesh`
///   parts   of the arrangement of the mesh
///   return  nothing if an edge is not used as often in one direction as in the other
///   throws  Error(cancelled)
[[nodiscard]] std::optional<std::vector<int>> windingInFront(
    const TriangleMesh& mesh, const TriangleTree& tree, std::span<const ArrangedTriangle> parts,
    const PointSet& points, const Progress* progress);

}  // namespace sherd
