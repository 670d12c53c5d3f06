// A level set's surface as triangles.
#pragma once

#include <sherd/coords.h>
#include <sherd/grid_fwd.h>
#include <sherd/mesh.h>

#include <vector>

namespace sherd {

struct LevelSetMesh {
  TriangleMesh mesh;           ///< world units, closed, oriented outwards
  std::vector<bool> original;  ///< [triangles] lies on the reference's surface; empty without one
};

/// Mesh the zero level with OpenVDB's dual mesher, without adaptivity: two triangles per quad,
/// split at the shorter diagonal.
///   frame      of the grid; vertices are found in index space and placed in double
///   reference  the level set this one was cut from, or null: faces on its surface are told and
///   seams are sharp
[[nodiscard]] LevelSetMesh meshLevelSet(const openvdb::FloatGrid& grid, const GridFrame& frame,
                                        const openvdb::FloatGrid* reference);

/// The surface where a grid's values are `isovalue`, of a grid with any transform, in world units.
[[nodiscard]] TriangleMesh meshInWorld(const openvdb::FloatGrid& grid, double isovalue = 0.0);

}  // namespace sherd
