// How often a mesh winds round a point.
#pragma once

#include <sherd/mesh.h>

namespace sherd {

/// The signed solid angles that the triangles are seen under, summed, in full turns: a whole number
/// for a closed mesh, up to rounding, but for points on its surface.  As slow as it is plain; the
/// solid's own winding numbers are exact and come from voxelize/winding.h.
///   cost    triangles
///   source  Van Oosterom and Strackee, The Solid Angle of a Plane Triangle, 1983
[[nodiscard]] double windingNumber(const TriangleMesh& mesh, const glm::dvec3& point);

}  // namespace sherd
