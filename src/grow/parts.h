// The parts of labelled voxels.
#pragma once

#include <sherd/device.h>
#include <sherd/labels.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// The inside voxels in the largest 6-connected part of their label: [leaf*8] words like
/// LeafBlocks::inside.  Of equal parts that with the first voxel in leaf order; voxels without a
/// label are in none.
///   throws  Error(device)
[[nodiscard]] std::vector<std::uint64_t> largestParts(const LeafBlocks& blocks,
                                                      const Labels& labels, Device& device);

}  // namespace sherd
