// Whether the input of a solid is flat.
#pragma once

#include <sherd/solid.h>

namespace sherd {

/// Returns whether most of a solid's input is flat as far as its voxels can show it, so that
/// kAutoAdaptivity merges triangles: not those of volumes and shells, and not where the input's
/// texture coordinates or colors are not linear in its planes.
[[nodiscard]] bool isPiecewiseFlat(const Solid& solid);

}  // namespace sherd
