// How many fragments there are, and their ids.
#pragma once

#include <sherd/solid.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sherd {

/// Returns how many fragments a solid breaks into: as many as pieces, and one for each component.
///   throws  Error(usage) more than kMaxFragments
[[nodiscard]] std::size_t countFragments(const VoxelComponents& components, int pieces);

/// Returns a random permutation of 1..n, so that ids do not depend on where fragments are.
[[nodiscard]] std::vector<std::uint16_t> permutedIds(std::size_t n, std::uint64_t seed);

}  // namespace sherd
