// Coarser fragments for previews.
#pragma once

#include <sherd/fragments.h>

namespace sherd {

/// Returns what renderFragments needs of a fragment: id, mass, mesh and neighbor.  For solids above
/// some 960 voxels along the longest side, the vertices in each of kPreviewCubes cubes along that
/// side merge at their mean, and faces that become degenerate are dropped.  A preview shows nothing
/// finer, and building a tree over all faces of a large solid costs more than making them.
///   source  Rossignac, Borrel, Multi-resolution 3D approximations for rendering complex scenes,
///           1993
[[nodiscard]] Fragment previewFragment(const Fragment& fragment, const Solid& solid);

}  // namespace sherd
