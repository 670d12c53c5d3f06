// Connected components on the device.  Method: kernels/components.cl.
#include "grow/fields/components.h"

#include <algorithm>

namespace sherd {

namespace {

DeviceLabels labelsOrNone(GrowthState& state, const DeviceLabels* labels) {
  return labels ? *labels
                : DeviceLabels{makeBuffer<std::uint16_t>(state.device, 1),
                               makeBuffer<std::uint32_t>(state.device, 1),
                               makeBuffer<std::uint64_t>(state.device, 1)};
}

}  // namespace

NodeComponents findNodes(GrowthState& state, const DeviceLabels* labels) {
  NodeComponents found;
  const auto byLabel = static_cast<std::uint32_t>(labels != nullptr);
  const DeviceLabels label = labelsOrNone(state, labels);
  found.localNode = makeBuffer<std::uint16_t>(state.device, state.voxels());
  found.nodeCount = makeBuffer<std::uint32_t>(state.device, state.items);
  state.run("component_nodes", state.items, state.inside, state.leafCount, state.items, label.owner,
            label.tag, label.second, byLabel, found.localNode, found.nodeCount);

  found.nodesOfItem = downloaded<std::uint32_t>(state.device, found.nodeCount, state.items);
  found.first.reserve(state.items);
  for (const std::uint32_t n : found.nodesOfItem) {
    found.first.push_back(found.nodes);
    found.nodes += n;
  }
  found.firstNode = uploadBuffer<std::uint32_t>(state.device, found.first);
  return found;
}

NodeComponents findNodeComponents(GrowthState& state, const DeviceLabels* labels) {
  NodeComponents found = findNodes(state, labels);
  const auto byLabel = static_cast<std::uint32_t>(labels != nullptr);
  const DeviceLabels label = labelsOrNone(state, labels);

  // Capacity for more nodes than most fractures have, so that the next one can reuse the buffers.
  const std::size_t capacity = std::max<std::size_t>(found.nodes, 8 * std::size_t{state.items});
  found.root = makeBuffer<std::uint32_t>(state.device, capacity);
  const DeviceBuffer parent = makeBuffer<std::uint32_t>(state.device, capacity);
  state.run("component_begin", found.nodes, found.nodes, parent);
  state.run("component_join", state.items, state.inside, state.neighbor, state.leafCount,
            state.items, label.owner, label.tag, label.second, byLabel, found.localNode,
            found.firstNode, found.nodeCount, parent);
  state.run("component_flatten", found.nodes, found.nodes, parent, found.root);
  return found;
}

bool KeptComponents::all() const {
  return std::all_of(disconnected.begin(), disconnected.end(),
                     [](std::uint32_t n) { return n == 0; });
}

namespace {

// Returns the voxels of the components marked in `keep` [nodes].
KeptComponents markedVoxels(GrowthState& state, const NodeComponents& components,
                            const DeviceBuffer& keep) {
  const DeviceBuffer disconnected = state.filled<std::uint32_t>(state.fractures, 0);
  KeptComponents kept{makeBuffer<std::uint64_t>(state.device, state.words()), {}};
  state.run("component_kept", state.items, state.inside, state.leafCount, state.items,
            components.localNode, components.firstNode, components.nodeCount, components.root, keep,
            kept.mask, disconnected);
  kept.disconnected.resize(state.fractures);
  readBuffer<std::uint32_t>(state.device, disconnected, kept.disconnected);
  return kept;
}

}  // namespace

KeptComponents keepSeededComponents(GrowthState& state, const DeviceLabels& labels,
                                    const SeedTable& seeds) {
  const NodeComponents components = findNodeComponents(state, &labels);
  const PrimarySeeds primaries = primariesOf(state, seeds);
  const DeviceBuffer keep = state.filled<std::uint32_t>(components.nodes, 0);
  state.run("component_mark", primaries.count, components.localNode, components.firstNode,
            components.nodeCount, components.root, primaries.item, primaries.offset,
            primaries.count, keep);
  return markedVoxels(state, components, keep);
}

KeptComponents keepLargestComponents(GrowthState& state, const DeviceLabels& labels) {
  const NodeComponents components = findNodeComponents(state, &labels);
  const DeviceBuffer voxelBuffer = makeBuffer<std::uint32_t>(state.device, components.nodes);
  const DeviceBuffer labelBuffer = makeBuffer<std::uint16_t>(state.device, components.nodes);
  state.run("component_measure", state.items, state.inside, state.leafCount, state.items,
            labels.owner, labels.tag, labels.second, components.localNode, components.firstNode,
            components.nodeCount, voxelBuffer, labelBuffer);
  std::vector<std::uint32_t> voxels =
      downloaded<std::uint32_t>(state.device, voxelBuffer, components.nodes);
  const auto root = downloaded<std::uint32_t>(state.device, components.root, components.nodes);
  const auto label = downloaded<std::uint16_t>(state.device, labelBuffer, components.nodes);

  // Nodes and roots ascend, so of equally large components the first stays the largest.
  for (std::uint32_t n = 0; n < components.nodes; ++n) {
    if (root[n] != n) voxels[root[n]] += voxels[n];
  }
  constexpr std::uint32_t kNone = SHERD_NO_LEAF;
  std::vector<std::uint32_t> keep(components.nodes, 0);
  std::uint32_t node = 0;
  for (std::uint32_t fracture = 0; fracture < state.fractures; ++fracture) {
    const std::size_t next = std::size_t{fracture + 1} * state.leafCount;
    const std::uint32_t end =
        next < components.first.size() ? components.first[next] : components.nodes;
    std::vector<std::uint32_t> largest(std::size_t{Labels::kEroded} + 1, kNone);
    for (; node < end; ++node) {
      if (root[node] != node || label[node] == 0) continue;
      std::uint32_t& best = largest[label[node]];
      if (best == kNone || voxels[node] > voxels[best]) best = node;
    }
    for (const std::uint32_t best : largest) {
      if (best != kNone) keep[best] = 1;
    }
  }
  return markedVoxels(state, components, uploadBuffer<std::uint32_t>(state.device, keep));
}

}  // namespace sherd
