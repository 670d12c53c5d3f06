// Parts on the device.  The method is described in kernels/components.cl.
#include "grow/components.h"

#include <algorithm>

namespace sherd {

NodeParts findNodeParts(GrowthState& state, const DeviceBuffer* labels) {
  NodeParts found;
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

  // Room for more nodes than most fractures have, so that the next one needs no other buffer.
  const std::size_t room = std::max<std::size_t>(found.nodes, 8 * std::size_t{state.items});
  found.firstNode = uploadBuffer<cl_uint>(state.device, found.first);
  found.root = makeBuffer<cl_uint>(state.device, room);
  const DeviceBuffer parent = makeBuffer<cl_uint>(state.device, room);
  state.run("component_begin", found.nodes, found.nodes, parent);
  state.run("component_join", state.items, state.inside, state.neighbour, state.leafCount,
            state.items, label, byLabel, found.localNode, found.firstNode, found.nodeCount, parent);
  state.run("component_flatten", found.nodes, found.nodes, parent, found.root);
  return found;
}

bool KeptParts::all() const {
  return std::all_of(freed.begin(), freed.end(), [](cl_uint n) { return n == 0; });
}

namespace {

// The voxels of the parts marked in `keep` [nodes].
KeptParts keptBy(GrowthState& state, const NodeParts& parts, const DeviceBuffer& keep) {
  const DeviceBuffer freed = state.filled<cl_uint>(state.fractures, 0);
  KeptParts kept{makeBuffer<cl_ulong>(state.device, state.words()), {}};
  state.run("component_kept", state.items, state.inside, state.leafCount, state.items,
            parts.localNode, parts.firstNode, parts.nodeCount, parts.root, keep, kept.mask, freed);
  kept.freed.resize(state.fractures);
  readBuffer<cl_uint>(state.device, freed, kept.freed);
  return kept;
}

}  // namespace

KeptParts keepSeededParts(GrowthState& state, const DeviceBuffer& labels, const SeedTable& seeds) {
  const NodeParts parts = findNodeParts(state, &labels);
  const PrimarySeeds primaries = primariesOf(state, seeds);
  const DeviceBuffer keep = state.filled<cl_uint>(parts.nodes, 0);
  state.run("component_mark", primaries.count, parts.localNode, parts.firstNode, parts.nodeCount,
            parts.root, primaries.item, primaries.offset, primaries.count, keep);
  return keptBy(state, parts, keep);
}

KeptParts keepLargestParts(GrowthState& state, const DeviceBuffer& labels) {
  const NodeParts parts = findNodeParts(state, &labels);
  const DeviceBuffer voxelBuffer = makeBuffer<cl_uint>(state.device, parts.nodes);
  const DeviceBuffer labelBuffer = makeBuffer<cl_ushort>(state.device, parts.nodes);
  state.run("component_measure", state.items, state.inside, state.leafCount, state.items, labels,
            parts.localNode, parts.firstNode, parts.nodeCount, voxelBuffer, labelBuffer);
  std::vector<cl_uint> voxels = downloaded<cl_uint>(state.device, voxelBuffer, parts.nodes);
  const auto root = downloaded<cl_uint>(state.device, parts.root, parts.nodes);
  const auto label = downloaded<cl_ushort>(state.device, labelBuffer, parts.nodes);

  // Nodes ascend, and so do roots: the first of equal parts stays the largest.
  for (cl_uint n = 0; n < parts.nodes; ++n) {
    if (root[n] != n) voxels[root[n]] += voxels[n];
  }
  constexpr cl_uint kNone = SHERD_NO_LEAF;
  std::vector<cl_uint> keep(parts.nodes, 0);
  cl_uint node = 0;
  for (cl_uint fracture = 0; fracture < state.fractures; ++fracture) {
    const std::size_t next = std::size_t{fracture + 1} * state.leafCount;
    const cl_uint end = next < parts.first.size() ? parts.first[next] : parts.nodes;
    std::vector<cl_uint> largest(std::size_t{Labels::kWorn} + 1, kNone);
    for (; node < end; ++node) {
      if (root[node] != node || label[node] == 0) continue;
      cl_uint& best = largest[label[node]];
      if (best == kNone || voxels[node] > voxels[best]) best = node;
    }
    for (const cl_uint best : largest) {
      if (best != kNone) keep[best] = 1;
    }
  }
  return keptBy(state, parts, uploadBuffer<cl_uint>(state.device, keep));
}

}  // namespace sherd
