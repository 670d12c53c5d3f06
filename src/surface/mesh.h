// A grid's surface as triangles.
#pragma once

#include <sherd/grid_fwd.h>
#include <sherd/mesh.h>

namespace sherd {

/// The surface where a grid's values are `isovalue`, of a grid with any transform, in world units:
/// by OpenVDB's dual mesher, without adaptivity, two triangles per quad, split at the shorter
/// diagonal.
[[nodiscard]] TriangleMesh meshInWorld(const openvdb::FloatGrid& grid, double isovalue = 0.0);

}  // namespace sherd
