// Connected components of labeled voxels.
#pragma once

#include <sherd/device.h>
#include <sherd/labels.h>

#include <cstdint>
#include <vector>

#include "grow/fields/apart_leaves.h"

namespace sherd {

/// Return the inside voxels in the largest 6-connected component of their label, [leaf*8] words as
/// in LeafBlocks::inside.  Ties go to the component with the first voxel in leaf order; voxels
/// without a label are not included.
///   throws  Error(device)
[[nodiscard]] std::vector<std::uint64_t> largestComponents(const Labels& labels, Device& device);

/// Returns the same components, of the voxels of leaves taken apart.
[[nodiscard]] VoxelComponents apartComponents(const VoxelComponents& components,
                                              const ApartLeaves& apart);

/// Returns the components of blocks by those of their leaves taken apart.
[[nodiscard]] VoxelComponents joinedComponents(const VoxelComponents& found,
                                               const ApartLeaves& apart, const LeafBlocks& blocks);

}  // namespace sherd
