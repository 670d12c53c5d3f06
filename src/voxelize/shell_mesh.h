// The closed mesh of a shell, for Surface::exact.
#pragma once

#include <sherd/solid.h>

namespace sherd {

/// Returns sheets with a thickness: every triangle twice, moved by half of it to both sides, and
/// faces between the two along open edges, whose source is the triangle there.  Vertices move
/// along the mean normal of the faces around them, so far that these faces move by half the
/// thickness, at most by kMostMiter times that.  Edges of more than two triangles, or of two that
/// have it in the same direction, are open edges of each.  So the result is closed, but may cross
/// itself.
///   sheets     without layers; the source of a back is SolidMesh::back where that is known
///   thickness  world units, above 0
[[nodiscard]] SolidMesh shellMesh(const SolidMesh& sheets, double thickness);

inline constexpr double kMostMiter = 2.0;

}  // namespace sherd
