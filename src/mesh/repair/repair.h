// Detection of mesh defects, and consistent orientation of triangles.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstdint>
#include <vector>

#include "mesh/repair/sheets.h"

namespace sherd {

struct Repaired {
  TriangleMesh mesh;                  ///< the same vertices
  std::vector<std::uint32_t> source;  ///< [triangles] index in the original mesh
  std::vector<SheetFace> sheets;  ///< those outside, oriented like their neighbors; none if they
                                  ///< are few
  MeshDefects defects;
};

/// Drops duplicate triangles, orients triangles like their neighbors, and flips components that are
/// inside out.
///
/// Of triangles with the same corners and orientation one is kept; a pair of opposite orientation
/// is dropped, because the solid is on both sides of it or on neither, and so are flat sheets that
/// have other triangles on each side.  Of these, `sheets` has those that lie outside.  If the edges
/// of a component do not balance, its triangles are flipped to agree across edges of two triangles;
/// each group keeps the orientation of most of its area.  A component with negative volume is
/// inside out; it is flipped unless it lies within another, where it bounds a cavity.
///   throws  Error(cancelled)
[[nodiscard]] Repaired repaired(const TriangleMesh& mesh, const Progress* progress = nullptr);

}  // namespace sherd
