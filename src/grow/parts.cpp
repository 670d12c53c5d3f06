// The 6-connected parts of the inside.  The method is described in kernels/components.cl.
#include "grow/parts.h"

#include <sherd/seeds.h>

#include <bit>

#include "grow/components.h"

namespace sherd {
namespace {

// Voxels of each part, and the parts numbered by their lowest node: nodes ascend with leaves and
// voxels.
void numberParts(const LeafBlocks& blocks, std::span<const cl_uint> nodeCount,
                 std::span<const cl_uint> root, Parts& parts) {
  parts.partOfNode.resize(root.size());
  for (std::size_t n = 0; n < root.size(); ++n) {
    if (root[n] == n) {
      parts.partOfNode[n] = static_cast<std::uint32_t>(parts.voxels.size());
      parts.voxels.push_back(0);
    } else {
      parts.partOfNode[n] = parts.partOfNode[root[n]];  // a root is lower than its nodes
    }
  }
  for (std::size_t word = 0; word < blocks.inside.size(); ++word) {
    const std::size_t leaf = word / SHERD_LEAF_WORDS;
    std::uint64_t bits = blocks.inside[word];
    if (nodeCount[leaf] == 1) {
      parts.voxels[parts.partOfNode[parts.firstNode[leaf]]] +=
          static_cast<std::uint64_t>(std::popcount(bits));
      continue;
    }
    for (; bits; bits &= bits - 1) {
      ++parts.voxels[parts.at(word * 64 + static_cast<std::size_t>(std::countr_zero(bits)))];
    }
  }
}

}  // namespace

Parts findParts(const LeafBlocks& blocks, Device& device) {
  Device::Impl& impl = device.impl();
  return withDevice(impl, "finding connected parts", [&] {
    GrowthState state(blocks, 1, impl);
    NodeParts found = findNodeParts(state);
    Parts parts;
    parts.localNode.resize(state.voxels());
    readBuffer<std::uint16_t>(impl, found.localNode, parts.localNode);
    std::vector<cl_uint> root(found.nodes);
    readBuffer<cl_uint>(impl, found.root, root);
    parts.firstNode = std::move(found.first);
    numberParts(blocks, found.nodesOfItem, root, parts);
    return parts;
  });
}

std::vector<std::uint64_t> largestParts(const LeafBlocks& blocks, const Labels& labels,
                                        Device& device) {
  Device::Impl& impl = device.impl();
  return withDevice(impl, "finding the largest parts", [&] {
    GrowthState state(blocks, 1, impl);
    const DeviceBuffer uploaded = uploadBuffer<std::uint16_t>(impl, labels.fragment);
    std::vector<std::uint64_t> mask(state.words());
    readBuffer<std::uint64_t>(impl, keepLargestParts(state, uploaded).mask, mask);
    return mask;
  });
}

}  // namespace sherd
