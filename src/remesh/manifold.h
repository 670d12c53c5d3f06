// Meshes whose sheets touch, made manifold.
#pragma once

#include "remesh/complex.h"

namespace sherd {

/// Gives each sheet of a closed mesh vertices of its own where sheets touch at vertices or along
/// edges: all edges have two triangles then, all vertices one fan, at the same positions.  Along an
/// edge of several sheets those two triangles stay connected that have the inside between them, or
/// the outside where the sheets are connected around both of its ends.
///   mesh    oriented outwards
///   return  false if the mesh is not closed; it is not changed then
[[nodiscard]] bool makeManifold(LabeledMesh& mesh);

}  // namespace sherd
