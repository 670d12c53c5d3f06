// How many fragments there are, and their ids.
#include "seed/fragment_ids.h"

#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "base/random.h"

namespace sherd {

std::size_t countFragments(const VoxelComponents& components, int pieces) {
  const std::size_t count = std::max(static_cast<std::size_t>(pieces), components.count());
  if (count > kMaxFragments) {
    throw Error(ErrorCode::usage,
                "the solid would give " + std::to_string(count) + " fragments; at most " +
                    std::to_string(kMaxFragments) + " are possible; try a lower resolution",
                OptionNames{"resolution"});
  }
  return count;
}

// Fisher and Yates.
std::vector<std::uint16_t> permutedIds(std::size_t n, std::uint64_t seed) {
  std::vector<std::uint16_t> ids(n);
  std::iota(ids.begin(), ids.end(), std::uint16_t{1});
  for (std::size_t i = n; i > 1; --i) {
    std::swap(ids[i - 1], ids[randomBelow(i, seed, Stage::fragmentId, i)]);
  }
  return ids;
}

}  // namespace sherd
