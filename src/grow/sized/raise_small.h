// Fragments that are too small to be pieces.
#pragma once

#include <sherd/labels.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace sherd {

/// Returns the least voxels of a fragment where none are asked for: kSmallComponentVoxels, or a
/// quarter of the mean if that is less.
[[nodiscard]] std::uint64_t leastVoxelsOf(std::uint64_t voxels, std::size_t fragments);

/// Gives fragments of fewer voxels those of their neighbors that are nearest to their middles,
/// until they have as many.  Neighbors stay connected, and keep as many; where none can give any a
/// fragment stays as it is.  One that another fragment encloses moves to the nearest voxel of that
/// which something else touches, and leaves no cavity.
///   labels  of the growth; those of the exterior band are not changed
///   return  ids of the fragments that changed places, ascending, each with its first voxel; and
///           those that were raised, with kNoVoxel
[[nodiscard]] std::vector<std::pair<std::uint16_t, std::size_t>> raiseSmallFragments(
    Labels& labels, std::uint64_t least);

}  // namespace sherd
