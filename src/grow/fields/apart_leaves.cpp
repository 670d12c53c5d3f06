// Leaves of voxels of several layers, taken apart.
#include "grow/fields/apart_leaves.h"

#include <algorithm>
#include <utility>

namespace sherd {
namespace {

// Calls visit(first, end) for the leaves of each layer.
template <class Visit>
void forEachLayer(std::size_t leaves, std::span<const std::uint32_t> firstOfLayer,
                  const Visit& visit) {
  if (firstOfLayer.empty()) return visit(std::size_t{0}, leaves);
  for (std::size_t layer = 0; layer + 1 < firstOfLayer.size(); ++layer) {
    visit(std::size_t{firstOfLayer[layer]}, std::size_t{firstOfLayer[layer + 1]});
  }
}

std::uint32_t numberedFrom(std::size_t first, std::uint32_t leaf) {
  return leaf == LeafBlocks::kNone ? leaf : leaf + static_cast<std::uint32_t>(first);
}

std::vector<std::uint32_t> neighborTable(std::span<const openvdb::Coord> origins,
                                         std::span<const std::uint32_t> firstOfLayer) {
  std::vector<std::uint32_t> all;
  forEachLayer(origins.size(), firstOfLayer, [&](std::size_t first, std::size_t end) {
    for (const std::uint32_t leaf : leafNeighborTable(origins.subspan(first, end - first))) {
      all.push_back(numberedFrom(first, leaf));
    }
  });
  return all;
}

// Returns the leaf with an origin, of those from `first` to `end`, or `end`.
std::size_t findOrigin(const LeafBlocks& blocks, std::size_t first, std::size_t end,
                       const openvdb::Coord& origin) {
  const auto begin = blocks.origins.begin();
  const auto at = std::lower_bound(begin + static_cast<std::ptrdiff_t>(first),
                                   begin + static_cast<std::ptrdiff_t>(end), origin);
  const auto leaf = static_cast<std::size_t>(at - begin);
  return leaf < end && *at == origin ? leaf : end;
}

}  // namespace

ApartLeaves apartLeaves(const LeafBlocks& blocks) {
  ApartLeaves apart;
  LeafBlocks out;
  for (std::size_t layer = 0; layer <= blocks.layers.size(); ++layer) {
    apart.firstOfLayer.push_back(static_cast<std::uint32_t>(out.count()));
    for (std::uint32_t leaf = 0; leaf < blocks.count(); ++leaf) {
      std::uint64_t any = 0;
      for (std::size_t x = 0; x < 8; ++x) any |= insideOfLayer(blocks, layer, leaf * 8ul + x);
      if (any == 0) continue;
      out.origins.push_back(blocks.origins[leaf]);
      apart.source.push_back(leaf);
      for (std::size_t x = 0; x < 8; ++x) {
        out.inside.push_back(insideOfLayer(blocks, layer, leaf * 8ul + x));
        out.exteriorBand.push_back(blocks.exteriorBand[leaf * 8ul + x]);
      }
    }
  }
  apart.firstOfLayer.push_back(static_cast<std::uint32_t>(out.count()));
  out.neighbors = neighborTable(out.origins, apart.firstOfLayer);
  apart.blocks = std::make_shared<const LeafBlocks>(std::move(out));
  return apart;
}

ApartLeaves insideOf(const LeafBlocks& blocks, std::span<const std::uint32_t> firstOfLayer,
                     std::span<const std::uint32_t> leaves) {
  ApartLeaves some;
  some.source.assign(leaves.begin(), leaves.end());
  for (const std::uint32_t first : firstOfLayer) {
    some.firstOfLayer.push_back(static_cast<std::uint32_t>(
        std::lower_bound(leaves.begin(), leaves.end(), first) - leaves.begin()));
  }
  LeafBlocks out;
  for (const std::size_t leaf : leaves) {
    const auto word = blocks.inside.begin() + static_cast<std::ptrdiff_t>(leaf * 8);
    out.origins.push_back(blocks.origins[leaf]);
    out.inside.insert(out.inside.end(), word, word + 8);
  }
  out.exteriorBand.resize(out.inside.size());
  out.neighbors = neighborTable(out.origins, some.firstOfLayer);
  some.blocks = std::make_shared<const LeafBlocks>(std::move(out));
  return some;
}

std::vector<LeafNeighbors> leafNeighbors(std::span<const openvdb::Coord> origins,
                                         std::span<const std::uint32_t> firstOfLayer) {
  std::vector<LeafNeighbors> all;
  all.reserve(origins.size());
  forEachLayer(origins.size(), firstOfLayer, [&](std::size_t first, std::size_t end) {
    for (LeafNeighbors each : leafNeighbors(origins.subspan(first, end - first))) {
      for (std::uint32_t& leaf : each) leaf = numberedFrom(first, leaf);
      all.push_back(each);
    }
  });
  return all;
}

std::uint32_t findBeside(const LeafBlocks& blocks, std::span<const std::uint32_t> firstOfLayer,
                         std::size_t leaf, const openvdb::Coord& offset) {
  std::uint32_t found = LeafBlocks::kNone;
  forEachLayer(blocks.count(), firstOfLayer, [&](std::size_t first, std::size_t end) {
    if (leaf < first || leaf >= end) return;
    const std::size_t at = findOrigin(blocks, first, end, blocks.origins[leaf] + offset);
    if (at != end) found = static_cast<std::uint32_t>(at);
  });
  return found;
}

std::size_t findInside(const LeafBlocks& blocks, std::span<const std::uint32_t> firstOfLayer,
                       const openvdb::Coord& voxel) {
  std::size_t found = kNoVoxel;
  forEachLayer(blocks.count(), firstOfLayer, [&](std::size_t first, std::size_t end) {
    const std::size_t leaf = findOrigin(blocks, first, end, voxel & ~7);
    if (leaf == end) return;
    const std::size_t index = leaf * 512 + offsetFromCoord(voxel);
    if (blocks.isInside(index)) found = index;
  });
  return found;
}

}  // namespace sherd
