// Seed placement.  It costs a search per seed, so it stays on the host.
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <string>
#include <unordered_set>

#include "random.h"

namespace sherd {
namespace {

// A voxel by leaf and offset, as one number that ascends in leaf order.
using VoxelKey = std::uint64_t;

// The inside voxels of one part (or of all), in leaf order, found by their number.
class VoxelIndex {
 public:
  VoxelIndex(const LeafBlocks& blocks, const Parts& parts) : blocks_(blocks), parts_(parts) {
    for (std::size_t word = 0; word < blocks.inside.size(); ++word) {
      before_.push_back(total_);
      total_ += static_cast<std::uint64_t>(std::popcount(blocks.inside[word]));
    }
  }

  std::uint64_t total() const { return total_; }

  VoxelKey ofAll(std::uint64_t number) const {
    const auto word =
        static_cast<std::size_t>(std::upper_bound(before_.begin(), before_.end(), number) -
                                 before_.begin()) -
        1;
    return word * 64 + nthBit(blocks_.inside[word], number - before_[word]);
  }

  // The voxels with these numbers in their parts: pick[part] is one of 0..voxels[part]-1.
  std::vector<VoxelKey> ofParts(std::vector<std::uint64_t> pick) const {
    std::vector<VoxelKey> found(pick.size());
    std::vector<bool> done(pick.size());
    for (std::size_t word = 0; word < blocks_.inside.size(); ++word) {
      for (std::uint64_t bits = blocks_.inside[word]; bits; bits &= bits - 1) {
        const VoxelKey key = word * 64 + static_cast<std::uint64_t>(std::countr_zero(bits));
        const std::uint32_t part = parts_.at(word / 8, static_cast<std::uint32_t>(key % 512));
        if (done[part] || pick[part]-- > 0) continue;
        found[part] = key;
        done[part] = true;
      }
    }
    return found;
  }

 private:
  static std::uint64_t nthBit(std::uint64_t bits, std::uint64_t n) {
    for (; n > 0; --n) bits &= bits - 1;
    return static_cast<std::uint64_t>(std::countr_zero(bits));
  }

  const LeafBlocks& blocks_;
  const Parts& parts_;
  std::vector<std::uint64_t> before_;  // [word] inside voxels in earlier words
  std::uint64_t total_ = 0;
};

// A random permutation of 1..n (Fisher and Yates).
std::vector<std::uint16_t> permutedIds(std::size_t n, std::uint64_t seed) {
  std::vector<std::uint16_t> ids(n);
  std::iota(ids.begin(), ids.end(), std::uint16_t{1});
  for (std::size_t i = n; i > 1; --i) {
    std::swap(ids[i - 1], ids[randomBelow(i, seed, Stage::fragmentId, i)]);
  }
  return ids;
}

}  // namespace

std::vector<Seed> placeSeeds(const LeafBlocks& blocks, const Parts& parts,
                             const SeedOptions& options) {
  const VoxelIndex voxels(blocks, parts);
  const std::size_t count =
      std::max(static_cast<std::size_t>(std::max(options.pieces, 1)), parts.count());
  if (count > kMaxFragments) {
    throw Error(ErrorCode::usage, "the solid would give " + std::to_string(count) +
                                      " fragments, at most " + std::to_string(kMaxFragments) +
                                      " have an id; try a lower --resolution");
  }
  if (count > voxels.total()) {
    throw Error(ErrorCode::usage, std::to_string(count) + " pieces are asked of a solid of " +
                                      std::to_string(voxels.total()) +
                                      " voxels; try a higher --resolution");
  }

  std::vector<std::uint64_t> pick;
  for (std::size_t p = 0; p < parts.count(); ++p) {
    pick.push_back(randomBelow(parts.voxels[p], options.seed, Stage::partSeed, p));
  }
  std::vector<VoxelKey> chosen = voxels.ofParts(std::move(pick));

  // The rest over all voxels: a draw that hits a taken voxel goes on to the next free one, so that
  // asking for as many pieces as voxels ends too.
  std::unordered_set<VoxelKey> taken(chosen.begin(), chosen.end());
  for (std::uint64_t item = 0; chosen.size() < count; ++item) {
    std::uint64_t number = randomBelow(voxels.total(), options.seed, Stage::seedVoxel, item);
    while (!taken.insert(voxels.ofAll(number)).second) number = (number + 1) % voxels.total();
    chosen.push_back(voxels.ofAll(number));
  }

  const std::vector<std::uint16_t> ids = permutedIds(count, options.seed);
  std::vector<Seed> seeds(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto offset = static_cast<std::uint32_t>(chosen[i] % 512);
    seeds[ids[i] - 1u] = {blocks.origins[chosen[i] / 512] + coordFromOffset(offset), ids[i]};
  }
  return seeds;
}

}  // namespace sherd
