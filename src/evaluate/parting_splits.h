// The split that parted two fragments.
#pragma once

#include <sherd/evaluate.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// Returns, for each triangle of a fragment, 0 on original surface, else the number of the split
/// that parted the fragment from its neighbor.  Neighbors that are not in the set, or were never
/// one piece with it, have numbers above all splits.
///   neighbor  [m] ids
///   return    [m]
[[nodiscard]] std::vector<std::uint32_t> partingSplits(const FragmentSet& set, std::size_t fragment,
                                                       std::span<const std::uint16_t> neighbor);

}  // namespace sherd
