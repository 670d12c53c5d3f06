// Removal of components too small to be fragments.
#pragma once

#include <sherd/seeds.h>
#include <sherd/solid.h>

namespace sherd {

/// Return the solid without its components of fewer than leastComponentVoxels, and count them in
/// `smallComponents`.
///   components  of the solid; updated
///   throws      Error(input) every component is that small
[[nodiscard]] Solid dropSmallComponents(Solid solid, VoxelComponents& components, Device& device);

}  // namespace sherd
