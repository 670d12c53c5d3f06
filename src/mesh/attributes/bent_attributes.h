// Where the surface attributes of a mesh are not linear in its planes.
#pragma once

#include <sherd/mesh.h>

#include "mesh/attributes/charts.h"

namespace sherd {

/// Returns the area of the triangles that are in one plane with a connected one, up to a tenth of a
/// degree, whose texture coordinates or colors continue theirs otherwise than linearly: by more
/// than a hundredth of their range in both triangles, or three levels of a color; and of those
/// beside a seam in their plane where a chart meets itself.  Triangles of such a plane cannot be
/// merged without moving its texture.
///   charts  of the mesh
[[nodiscard]] double bentArea(const TriangleMesh& mesh, const Charts& charts);

}  // namespace sherd
