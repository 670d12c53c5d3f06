// Flooding parts, a leaf at a time.
#include "erode/largest_part.h"

#include <utility>

namespace sherd {
namespace {

constexpr std::uint64_t kLowestZ = 0x0101010101010101u;  // the bits of z = 0
constexpr std::uint64_t kHighestZ = kLowestZ << 7;

// `bits` and their face neighbours of the same x.
std::uint64_t spread(std::uint64_t bits) {
  return bits | (bits << 8) | (bits >> 8) | ((bits & ~kHighestZ) << 1) | ((bits & ~kLowestZ) >> 1);
}

// All of `within` that a leaf's voxels reach over faces.
LeafMask flooded(LeafMask reached, const LeafMask& within) {
  for (bool grew = true; grew;) {
    grew = false;
    for (std::size_t x = 0; x < 8; ++x) {
      std::uint64_t bits = spread(reached[x]);
      if (x > 0) bits |= reached[x - 1];
      if (x < 7) bits |= reached[x + 1];
      bits &= within[x];
      grew = grew || bits != reached[x];
      reached[x] = bits;
    }
  }
  return reached;
}

// The voxels of a leaf seen from the leaf at `round`: those beyond a face, on this side of it.
LeafMask across(const LeafMask& mask, std::size_t round) {
  LeafMask beyond{};
  if (round == 4) beyond[7] = mask[0];
  if (round == 22) beyond[0] = mask[7];
  for (std::size_t x = 0; x < 8; ++x) {
    if (round == 10) beyond[x] = mask[x] << 56;
    if (round == 16) beyond[x] = mask[x] >> 56;
    if (round == 12) beyond[x] = (mask[x] & kLowestZ) << 7;
    if (round == 14) beyond[x] = (mask[x] & kHighestZ) >> 7;
  }
  return beyond;
}

openvdb::Coord lowestVoxel(const openvdb::Coord& origin, const LeafMask& mask) {
  std::uint32_t x = 0;
  while (mask[x] == 0) ++x;
  return origin + coordFromOffset(x * 64 + static_cast<std::uint32_t>(std::countr_zero(mask[x])));
}

struct Part {
  std::uint64_t voxels = 0;
  openvdb::Coord lowest;
  std::vector<std::pair<std::uint32_t, LeafMask>> leaves;  // a leaf may come more than once
};

// Whether `a` stays rather than `b`.
bool outranks(const Part& a, const Part& b) {
  return a.voxels != b.voxels ? a.voxels > b.voxels : a.lowest < b.lowest;
}

// Take the part that `start` lies in out of `remaining`.
Part takePart(const FragmentMasks& fragment, std::vector<LeafMask>& remaining, std::uint32_t leaf,
              const LeafMask& start) {
  Part part;
  std::vector<std::pair<std::uint32_t, LeafMask>> open{{leaf, start}};
  while (!open.empty()) {
    const auto [at, entered] = open.back();
    open.pop_back();
    LeafMask seeds = entered;
    for (std::size_t x = 0; x < 8; ++x) seeds[x] &= remaining[at][x];
    if (isEmpty(seeds)) continue;
    const LeafMask reached = flooded(seeds, remaining[at]);
    for (std::size_t x = 0; x < 8; ++x) remaining[at][x] &= ~reached[x];
    const openvdb::Coord lowest = lowestVoxel(fragment.origins[at], reached);
    if (part.voxels == 0 || lowest < part.lowest) part.lowest = lowest;
    part.voxels += voxelsIn(reached);
    part.leaves.emplace_back(at, reached);
    for (const std::size_t round : {4, 10, 12, 14, 16, 22}) {
      const std::uint32_t beside = fragment.round[at][round];
      if (beside == LeafBlocks::kNone) continue;
      const LeafMask beyond = across(reached, round);
      if (!isEmpty(beyond)) open.emplace_back(beside, beyond);
    }
  }
  return part;
}

}  // namespace

std::vector<LeafMask> largestPart(const FragmentMasks& fragment) {
  std::vector<LeafMask> remaining = fragment.masks;
  Part largest;
  for (std::uint32_t leaf = 0; leaf < remaining.size(); ++leaf) {
    for (std::size_t x = 0; x < 8; ++x) {
      while (remaining[leaf][x]) {
        LeafMask start{};
        start[x] = remaining[leaf][x] & -remaining[leaf][x];  // the lowest bit
        Part part = takePart(fragment, remaining, leaf, start);
        if (outranks(part, largest)) largest = std::move(part);
      }
    }
  }
  std::vector<LeafMask> masks(remaining.size(), LeafMask{});
  for (const auto& [leaf, mask] : largest.leaves) {
    for (std::size_t x = 0; x < 8; ++x) masks[leaf][x] |= mask[x];
  }
  return masks;
}

}  // namespace sherd
