// One fragment meshed by itself.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <cstdint>
#include <span>

#include "surface/complex.h"
#include "surface/cut.h"

namespace sherd {

/// The surface of a fragment's level set, max(solid, cut), whatever its neighbors are: all that is
/// not the fragment counts as one.  Made as InterfaceMeshes makes the meshes of all labels, so it
/// is closed and edge-manifold, voxels that are connected by faces are one body, and rims are
/// sharp.
///   leaves  those that concern the fragment: that have or touch voxels of it
///   return  `other` is 0 on the solid's surface, else Labels::kWorn
[[nodiscard]] LabelledMesh meshOfOne(const Solid& solid, const Labels& labels, const Cut& cut,
                                     std::uint16_t fragment, std::span<const std::uint32_t> leaves);

}  // namespace sherd
