// The voxels of a mesh whose holes were closed.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

namespace sherd {

struct ClosedSolid {
  Solid solid{};    ///< its blocks alone are other than those given
  Labels labels{};  ///< of these blocks
};

/// What decides which label goes on into the voxels that are added.
enum class Extension {
  steps,  ///< the fewest steps over faces
  cells,  ///< the fragment's cell where that is known (see cellsOf), and then steps
};

/// Adds the voxels that are inside a closed mesh, with the label of what they are connected to, and
/// an exterior band around them.  Faces that close holes may lie farther beyond the solid than
/// cracks overhang it: its own holes are closed where the winding number is 0.5, which is inwards
/// of two rims that face each other.
///   solid   without layers
///   throws  Error(cancelled)
[[nodiscard]] ClosedSolid closedSolid(const Solid& solid, const Labels& labels,
                                      const TriangleMesh& closed,
                                      const Progress* progress = nullptr,
                                      Extension extension = Extension::steps);

}  // namespace sherd
