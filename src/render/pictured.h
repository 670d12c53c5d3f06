// Fragments as a picture needs them.
#pragma once

#include <sherd/fragments.h>

namespace sherd {

/// Of a fragment what renderFragments looks at: id, mass, mesh and facing.  Of solids of more than
/// some 960 voxels the mesh is coarser: its vertices in one of kPreviewCubes cubes along the
/// longest side become one, at their mean, and faces go that have no area then.  A preview shows
/// nothing finer, and a tree over all faces of a large solid takes more time and memory than making
/// them.
///   source  Rossignac, Borrel, Multi-resolution 3D approximations for rendering complex scenes,
///           1993
[[nodiscard]] Fragment pictured(const Fragment& fragment, const Solid& solid);

}  // namespace sherd
