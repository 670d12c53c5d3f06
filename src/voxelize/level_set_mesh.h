// Triangle meshes of level sets.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

namespace sherd {

/// Returns the isosurface of a grid with any transform, in world units, by OpenVDB's VolumeToMesh
/// without adaptivity.  Quads are split at the shorter diagonal.
[[nodiscard]] TriangleMesh meshInWorld(const openvdb::FloatGrid& grid, double isovalue = 0.0);

}  // namespace sherd
