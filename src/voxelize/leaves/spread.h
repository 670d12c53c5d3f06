// Values of voxels that go on to others.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sherd {

/// The voxels from which values go on.
enum class SpreadFrom { all, inside };

/// Gives voxels the value of one beside them, front by front; where several have values, that of
/// the first side.
///   open    voxels without a value
///   values  [voxels] 0: none, and nothing goes on from there; changed
///   return  those that none reaches
///   throws  Error(cancelled)
std::vector<std::size_t> spread(const LeafBlocks& blocks, std::vector<std::size_t> open,
                                std::vector<std::uint16_t>& values, const Progress* progress,
                                SpreadFrom from = SpreadFrom::all);

}  // namespace sherd
