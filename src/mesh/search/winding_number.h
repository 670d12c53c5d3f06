// The winding number of a mesh around a point.
#pragma once

#include <sherd/mesh.h>

namespace sherd {

/// Returns the sum of the triangles' signed solid angles divided by 4 pi: an integer for a closed
/// mesh, up to rounding, except for points on its surface.  A direct sum, and slow; the exact
/// winding numbers of voxel centers come from voxelize/fill/winding.h.
///   cost    triangles
///   source  Van Oosterom and Strackee, The Solid Angle of a Plane Triangle, 1983
[[nodiscard]] double windingNumber(const TriangleMesh& mesh, const glm::dvec3& point);

}  // namespace sherd
