// Labels of the exterior band.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <bit>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "surface/exact/crack_surface.h"

namespace sherd {
namespace {

template <class Visit>
void forEachBandVoxel(const LeafBlocks& blocks, std::size_t leaf, const Visit& visit) {
  for (std::size_t x = 0; x < 8; ++x) {
    for (std::uint64_t bits = blocks.exteriorBand[leaf * 8 + x]; bits; bits &= bits - 1) {
      visit(x * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
    }
  }
}

// Returns the fragment with the least distance to its cell; `own` of several.
std::uint16_t ownerAt(const CutLeaf& cut, std::size_t offset, std::uint16_t own) {
  float least = float{kHalfWidthVoxels};
  std::uint16_t owner = own;
  for (std::size_t i = 0; i < cut.fragments.size(); ++i) {
    const float d = cut.distance[i * 512 + offset];
    if (d < least || (d == least && cut.fragments[i] == own)) {
      least = d;
      owner = cut.fragments[i];
    }
  }
  return owner;
}

// Gives the voxels of the band that have no label that of a neighbor, layer by layer.
void fillBand(const LeafBlocks& blocks, std::span<const LeafNeighbors> neighborhoods,
              std::vector<std::uint16_t>& labels) {
  std::vector<std::size_t> unlabeled;
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    forEachBandVoxel(blocks, leaf, [&](std::size_t v) {
      if (labels[leaf * 512 + v] == 0) unlabeled.push_back(leaf * 512 + v);
    });
  }
  const auto labelBeside = [&](std::size_t voxel) {
    const openvdb::Coord at = coordFromOffset(static_cast<std::uint32_t>(voxel % 512));
    for (int k = 0; k < 27; ++k) {
      const int x = at.x() + k / 9 - 1, y = at.y() + k / 3 % 3 - 1, z = at.z() + k % 3 - 1;
      const auto slot =
          static_cast<std::size_t>(((x >> 3) + 1) * 9 + ((y >> 3) + 1) * 3 + (z >> 3) + 1);
      const std::uint32_t leaf = neighborhoods[voxel / 512][slot];
      if (leaf == LeafBlocks::kNone) continue;
      const std::uint16_t label = labels[std::size_t{leaf} * 512 + offsetFromCoord({x, y, z})];
      if (label != 0) return label;
    }
    return std::uint16_t{0};
  };
  while (!unlabeled.empty()) {
    std::vector<std::pair<std::size_t, std::uint16_t>> found;
    std::vector<std::size_t> rest;
    for (const std::size_t voxel : unlabeled) {
      const std::uint16_t label = labelBeside(voxel);
      if (label != 0) {
        found.push_back({voxel, label});
      } else {
        rest.push_back(voxel);
      }
    }
    if (found.empty()) return;
    for (const auto& [voxel, label] : found) labels[voxel] = label;
    unlabeled = std::move(rest);
  }
}

}  // namespace

Labels labelsBeyond(const Solid& solid, const Labels& labels, const Cut& cut,
                    std::span<const LeafNeighbors> neighborhoods) {
  const LeafBlocks& blocks = *solid.blocks;
  auto filled = std::make_shared<LeafBlocks>(blocks);
  Labels out{.blocks = {}, .fragmentCount = labels.fragmentCount, .fragment = labels.fragment};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.count(), 64), [&](const auto& range) {
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      if (cut.index[leaf] == Cut::kWhole) {
        forEachBandVoxel(blocks, leaf, [&](std::size_t v) {
          std::uint16_t& label = out.fragment[leaf * 512 + v];
          if (label == 0) label = cut.only[leaf];
        });
        continue;
      }
      const CutLeaf& cells = cut.leaves[cut.index[leaf]];
      forEachBandVoxel(blocks, leaf, [&](std::size_t v) {
        std::uint16_t& label = out.fragment[leaf * 512 + v];
        label = ownerAt(cells, v, label);
      });
    }
  });
  fillBand(blocks, neighborhoods, out.fragment);
  for (std::size_t word = 0; word < filled->inside.size(); ++word) {
    filled->inside[word] |= filled->exteriorBand[word];
    filled->exteriorBand[word] = 0;
  }
  out.blocks = std::move(filled);
  return out;
}

}  // namespace sherd
