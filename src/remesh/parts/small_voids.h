// Small voids of the solid inside a fragment.
#pragma once

#include "remesh/complex.h"

namespace sherd {

/// Removes what encloses a void of the solid of less than kSmallComponentVoxels, as where two bones
/// of a skeleton touch: a few triangles inside the fragment, mostly of less than a voxel.
[[nodiscard]] LabeledMesh withoutSmallVoids(LabeledMesh all, double voxelSize);

}  // namespace sherd
