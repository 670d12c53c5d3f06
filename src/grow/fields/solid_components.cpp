// 6-connected components of the inside.  Method: kernels/components.cl.
#include "grow/fields/solid_components.h"

#include <sherd/seeds.h>

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

#include "grow/fields/apart_leaves.h"
#include "grow/fields/components.h"

namespace sherd {
namespace {

// Numbers the components by their lowest node; nodes ascend with leaves and voxels.  Returns the
// component of each node, and the number of components.
std::pair<std::vector<std::uint32_t>, std::size_t> componentsOfNodes(
    std::span<const std::uint32_t> root) {
  std::vector<std::uint32_t> component(root.size());
  std::size_t count = 0;
  for (std::size_t n = 0; n < root.size(); ++n) {
    // A root is its component's lowest node, so those below n have their number.
    component[n] = root[n] == n ? static_cast<std::uint32_t>(count++) : component[root[n]];
  }
  return {std::move(component), count};
}

std::vector<std::uint64_t> voxelsOf(const VoxelComponents& components, std::size_t count,
                                    const LeafBlocks& blocks,
                                    std::span<const std::uint32_t> nodesOfLeaf) {
  std::vector<std::uint64_t> voxels(count);
  for (std::size_t word = 0; word < blocks.inside.size(); ++word) {
    std::uint64_t bits = blocks.inside[word];
    const auto at = [&] {
      return components.at(word * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
    };
    if (bits != 0 && nodesOfLeaf[word / SHERD_LEAF_WORDS] == 1) {
      voxels[at()] += static_cast<std::uint64_t>(std::popcount(bits));
      continue;
    }
    for (; bits; bits &= bits - 1) ++voxels[at()];
  }
  return voxels;
}

// Returns the leaves of more than one node.
std::vector<std::uint32_t> sharedLeaves(const NodeComponents& found) {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t leaf = 0; leaf < found.nodesOfItem.size(); ++leaf) {
    if (found.nodesOfItem[leaf] >= 2) leaves.push_back(leaf);
  }
  return leaves;
}

std::vector<std::uint16_t> localNodes(GrowthState& state, const NodeComponents& found,
                                      const std::vector<std::uint32_t>& leaves) {
  const std::size_t voxels = leaves.size() * SHERD_LEAF_SIZE;
  const DeviceBuffer gathered = makeBuffer<std::uint16_t>(state.device, voxels);
  state.run("gather_voxels", leaves.size(), found.localNode,
            uploadBuffer<std::uint32_t>(state.device, leaves),
            static_cast<std::uint32_t>(leaves.size()), gathered);
  return downloaded<std::uint16_t>(state.device, gathered, voxels);
}

}  // namespace

VoxelComponents findComponents(const LeafBlocks& blocks, Device& device) {
  if (!blocks.layers.empty()) {
    const ApartLeaves apart = apartLeaves(blocks);
    return joinedComponents(findComponents(*apart.blocks, device), apart, blocks);
  }
  DeviceImpl& impl = implOf(device);
  GrowthState state(blocks, 1, impl);
  NodeComponents found = findNodeComponents(state);
  const std::vector<std::uint32_t> leaves = sharedLeaves(found);
  VoxelComponents components;
  components.firstLocal_.assign(found.nodesOfItem.size(), VoxelComponents::kOneNode);
  for (std::uint32_t i = 0; i < leaves.size(); ++i) components.firstLocal_[leaves[i]] = i;
  components.localNode_ = localNodes(state, found, leaves);
  components.firstNode_ = std::move(found.first);
  std::size_t count = 0;
  std::tie(components.componentOfNode_, count) =
      componentsOfNodes(downloaded<std::uint32_t>(impl, found.root, found.nodes));
  components.voxels_ = voxelsOf(components, count, blocks, found.nodesOfItem);
  return components;
}

VoxelComponents apartComponents(const VoxelComponents& components, const ApartLeaves& apart) {
  VoxelComponents own = components;
  own.firstNode_ = apart.gathered(std::span<const std::uint32_t>(components.firstNode_));
  own.firstLocal_ = apart.gathered(std::span<const std::uint32_t>(components.firstLocal_));
  return own;
}

VoxelComponents joinedComponents(const VoxelComponents& found, const ApartLeaves& apart,
                                 const LeafBlocks& blocks) {
  constexpr std::uint32_t kUnknown = 0xffffffffu;
  std::vector<std::uint32_t> number(found.count(), kUnknown);
  std::vector<std::uint32_t> component(blocks.count() * 512, kUnknown);
  apart.blocks->forEachInside([&](std::size_t voxel) {
    component[std::size_t{apart.source[voxel / 512]} * 512 + voxel % 512] = found.at(voxel);
  });
  VoxelComponents joined;
  joined.voxels_.resize(found.count());
  std::uint32_t next = 0;
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    std::vector<std::uint32_t> nodes;  // the components of the leaf
    std::vector<std::uint16_t> local(512, 0);
    for (std::size_t v = 0; v < 512; ++v) {
      std::uint32_t own = component[leaf * 512 + v];
      if (own == kUnknown) continue;
      if (number[own] == kUnknown) {
        joined.voxels_[next] = found.voxels()[own];
        number[own] = next++;
      }
      own = number[own];
      auto at = std::find(nodes.begin(), nodes.end(), own);
      if (at == nodes.end()) at = nodes.insert(at, own);
      local[v] = static_cast<std::uint16_t>(at - nodes.begin());
    }
    joined.firstNode_.push_back(static_cast<std::uint32_t>(joined.componentOfNode_.size()));
    joined.componentOfNode_.insert(joined.componentOfNode_.end(), nodes.begin(), nodes.end());
    joined.firstLocal_.push_back(VoxelComponents::kOneNode);
    if (nodes.size() < 2) continue;
    joined.firstLocal_.back() = static_cast<std::uint32_t>(joined.localNode_.size() / 512);
    joined.localNode_.insert(joined.localNode_.end(), local.begin(), local.end());
  }
  return joined;
}

std::vector<std::uint64_t> largestComponents(const Labels& labels, Device& device) {
  DeviceImpl& impl = implOf(device);
  GrowthState state(*labels.blocks, 1, impl);
  const DeviceBuffer uploaded = uploadBuffer<std::uint16_t>(impl, labels.fragment);
  return downloaded<std::uint64_t>(
      impl, keepLargestComponents(state, labelsPerVoxel(state, uploaded)).mask, state.words());
}

}  // namespace sherd
