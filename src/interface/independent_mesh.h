// Meshes one fragment independently of the others.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <cstdint>
#include <span>

#include "cut/cut.h"
#include "interface/cells/creases.h"
#include "remesh/complex.h"

namespace sherd {

/// Returns the surface of a fragment's level set, max(solid, cut), with all other labels merged
/// into one.  Meshed by InterfaceMeshes, so it is closed and edge-manifold, face-connected voxels
/// form one component, and contact boundaries are sharp.  Voids of the solid of less than
/// kSmallComponentVoxels are left out.
///   creases  of the solid
///   leaves  those within two voxels of the fragment, ascending
///   return  `other` is 0 on the solid's surface, else Labels::kEroded
[[nodiscard]] LabeledMesh meshOfOne(const Solid& solid, const Labels& labels, const Cut& cut,
                                    const Creases& creases, std::uint16_t fragment,
                                    std::span<const std::uint32_t> leaves);

}  // namespace sherd
