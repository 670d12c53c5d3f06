// 6-connected components of the inside.  Method: kernels/components.cl.
#include "grow/solid_components.h"

#include <sherd/seeds.h>

#include <bit>

#include "grow/components.h"

namespace sherd {
namespace {

// Numbers the components by their lowest node and counts their voxels; nodes ascend with leaves and
// voxels.
void numberComponents(const LeafBlocks& blocks, std::span<const cl_uint> nodeCount,
                      std::span<const cl_uint> root, VoxelComponents& components) {
  components.componentOfNode.resize(root.size());
  for (std::size_t n = 0; n < root.size(); ++n) {
    if (root[n] == n) {
      components.componentOfNode[n] = static_cast<std::uint32_t>(components.voxels.size());
      components.voxels.push_back(0);
    } else {
      components.componentOfNode[n] =
          components.componentOfNode[root[n]];  // root[n] < n has its number
    }
  }
  for (std::size_t word = 0; word < blocks.inside.size(); ++word) {
    const std::size_t leaf = word / SHERD_LEAF_WORDS;
    std::uint64_t bits = blocks.inside[word];
    if (nodeCount[leaf] == 1) {
      components.voxels[components.componentOfNode[components.firstNode[leaf]]] +=
          static_cast<std::uint64_t>(std::popcount(bits));
      continue;
    }
    for (; bits; bits &= bits - 1) {
      ++components
            .voxels[components.at(word * 64 + static_cast<std::size_t>(std::countr_zero(bits)))];
    }
  }
}

void readLocalNodes(GrowthState& state, const NodeComponents& found, VoxelComponents& components) {
  std::vector<cl_uint> leaves;
  components.firstLocal.assign(state.items, VoxelComponents::kOneNode);
  for (cl_uint leaf = 0; leaf < state.items; ++leaf) {
    if (found.nodesOfItem[leaf] < 2) continue;
    components.firstLocal[leaf] = static_cast<std::uint32_t>(leaves.size());
    leaves.push_back(leaf);
  }
  const std::size_t voxels = leaves.size() * SHERD_LEAF_SIZE;
  const DeviceBuffer gathered = makeBuffer<cl_ushort>(state.device, voxels);
  state.run("gather_voxels", leaves.size(), found.localNode,
            uploadBuffer<cl_uint>(state.device, leaves), static_cast<cl_uint>(leaves.size()),
            gathered);
  components.localNode = downloaded<std::uint16_t>(state.device, gathered, voxels);
}

}  // namespace

VoxelComponents findComponents(const LeafBlocks& blocks, Device& device) {
  Device::Impl& impl = device.impl();
  return withDevice(impl, "finding connected components", [&] {
    GrowthState state(blocks, 1, impl);
    NodeComponents found = findNodeComponents(state);
    VoxelComponents components;
    readLocalNodes(state, found, components);
    const std::vector<cl_uint> root = downloaded<cl_uint>(impl, found.root, found.nodes);
    components.firstNode = std::move(found.first);
    numberComponents(blocks, found.nodesOfItem, root, components);
    return components;
  });
}

std::vector<std::uint64_t> largestComponents(const LeafBlocks& blocks, const Labels& labels,
                                             Device& device) {
  Device::Impl& impl = device.impl();
  return withDevice(impl, "finding the largest components", [&] {
    GrowthState state(blocks, 1, impl);
    const DeviceBuffer uploaded = uploadBuffer<std::uint16_t>(impl, labels.fragment);
    return downloaded<std::uint64_t>(impl, keepLargestComponents(state, uploaded).mask,
                                     state.words());
  });
}

}  // namespace sherd
