// Connected components on the device.  Method: kernels/components.cl.
#include "grow/components.h"

#include <algorithm>

namespace sherd {

NodeComponents findNodeComponents(GrowthState& state, const DeviceBuffer* labels) {
  NodeComponents found;
  const auto byLabel = static_cast<cl_uint>(labels != nullptr);
  const DeviceBuffer label = labels ? *labels : makeBuffer<cl_ushort>(state.device, 1);
  found.localNode = makeBuffer<cl_ushort>(state.device, state.voxels());
  found.nodeCount = makeBuffer<cl_uint>(state.device, state.items);
  state.run("component_nodes", state.items, state.inside, state.leafCount, state.items, label,
            byLabel, found.localNode, found.nodeCount);

  found.nodesOfItem = downloaded<cl_uint>(state.device, found.nodeCount, state.items);
  found.first.reserve(state.items);
  for (const cl_uint n : found.nodesOfItem) {
    found.first.push_back(found.nodes);
    found.nodes += n;
  }

  // Capacity for more nodes than most fractures have, so that the next one can reuse the buffers.
  const std::size_t capacity = std::max<std::size_t>(found.nodes, 8 * std::size_t{state.items});
  found.firstNode = uploadBuffer<cl_uint>(state.device, found.first);
  found.root = makeBuffer<cl_uint>(state.device, capacity);
  const DeviceBuffer parent = makeBuffer<cl_uint>(state.device, capacity);
  state.run("component_begin", found.nodes, found.nodes, parent);
  state.run("component_join", state.items, state.inside, state.neighbor, state.leafCount,
            state.items, label, byLabel, found.localNode, found.firstNode, found.nodeCount, parent);
  state.run("component_flatten", found.nodes, found.nodes, parent, found.root);
  return found;
}

bool KeptComponents::all() const {
  return std::all_of(disconnected.begin(), disconnected.end(), [](cl_uint n) { return n == 0; });
}

namespace {

// Returns the voxels of the components marked in `keep` [nodes].
KeptComponents markedVoxels(GrowthState& state, const NodeComponents& components,
                            const DeviceBuffer& keep) {
  const DeviceBuffer disconnected = state.filled<cl_uint>(state.fractures, 0);
  KeptComponents kept{makeBuffer<cl_ulong>(state.device, state.words()), {}};
  state.run("component_kept", state.items, state.inside, state.leafCount, state.items,
            components.localNode, components.firstNode, components.nodeCount, components.root, keep,
            kept.mask, disconnected);
  kept.disconnected.resize(state.fractures);
  readBuffer<cl_uint>(state.device, disconnected, kept.disconnected);
  return kept;
}

}  // namespace

KeptComponents keepSeededComponents(GrowthState& state, const DeviceBuffer& labels,
                                    const SeedTable& seeds) {
  const NodeComponents components = findNodeComponents(state, &labels);
  const PrimarySeeds primaries = primariesOf(state, seeds);
  const DeviceBuffer keep = state.filled<cl_uint>(components.nodes, 0);
  state.run("component_mark", primaries.count, components.localNode, components.firstNode,
            components.nodeCount, components.root, primaries.item, primaries.offset,
            primaries.count, keep);
  return markedVoxels(state, components, keep);
}

KeptComponents keepLargestComponents(GrowthState& state, const DeviceBuffer& labels) {
  const NodeComponents components = findNodeComponents(state, &labels);
  const DeviceBuffer voxelBuffer = makeBuffer<cl_uint>(state.device, components.nodes);
  const DeviceBuffer labelBuffer = makeBuffer<cl_ushort>(state.device, components.nodes);
  state.run("component_measure", state.items, state.inside, state.leafCount, state.items, labels,
            components.localNode, components.firstNode, components.nodeCount, voxelBuffer,
            labelBuffer);
  std::vector<cl_uint> voxels = downloaded<cl_uint>(state.device, voxelBuffer, components.nodes);
  const auto root = downloaded<cl_uint>(state.device, components.root, components.nodes);
  const auto label = downloaded<cl_ushort>(state.device, labelBuffer, components.nodes);

  // Nodes and roots ascend, so of equally large components the first stays the largest.
  for (cl_uint n = 0; n < components.nodes; ++n) {
    if (root[n] != n) voxels[root[n]] += voxels[n];
  }
  constexpr cl_uint kNone = SHERD_NO_LEAF;
  std::vector<cl_uint> keep(components.nodes, 0);
  cl_uint node = 0;
  for (cl_uint fracture = 0; fracture < state.fractures; ++fracture) {
    const std::size_t next = std::size_t{fracture + 1} * state.leafCount;
    const cl_uint end = next < components.first.size() ? components.first[next] : components.nodes;
    std::vector<cl_uint> largest(std::size_t{Labels::kEroded} + 1, kNone);
    for (; node < end; ++node) {
      if (root[node] != node || label[node] == 0) continue;
      cl_uint& best = largest[label[node]];
      if (best == kNone || voxels[node] > voxels[best]) best = node;
    }
    for (const cl_uint best : largest) {
      if (best != kNone) keep[best] = 1;
    }
  }
  return markedVoxels(state, components, uploadBuffer<cl_uint>(state.device, keep));
}

}  // namespace sherd
