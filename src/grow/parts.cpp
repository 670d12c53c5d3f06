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

void readLocalNodes(GrowthState& state, const NodeParts& found, Parts& parts) {
  std::vector<cl_uint> several;
  parts.firstLocal.assign(state.items, Parts::kOneNode);
  for (cl_uint leaf = 0; leaf < state.items; ++leaf) {
    if (found.nodesOfItem[leaf] < 2) continue;
    parts.firstLocal[leaf] = static_cast<std::uint32_t>(several.size());
    several.push_back(leaf);
  }
  const std::size_t voxels = several.size() * SHERD_LEAF_SIZE;
  const DeviceBuffer gathered = makeBuffer<cl_ushort>(state.device, voxels);
  state.run("component_gather", several.size(), found.localNode,
            uploadBuffer<cl_uint>(state.device, several), static_cast<cl_uint>(several.size()),
            gathered);
  parts.localNode = downloaded<std::uint16_t>(state.device, gathered, voxels);
}

}  // namespace

Parts findParts(const LeafBlocks& blocks, Device& device) {
  Device::Impl& impl = device.impl();
  return withDevice(impl, "finding connected parts", [&] {
    GrowthState state(blocks, 1, impl);
    NodeParts found = findNodeParts(state);
    Parts parts;
    readLocalNodes(state, found, parts);
    const std::vector<cl_uint> root = downloaded<cl_uint>(impl, found.root, found.nodes);
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
    return downloaded<std::uint64_t>(impl, keepLargestParts(state, uploaded).mask, state.words());
  });
}

}  // namespace sherd
