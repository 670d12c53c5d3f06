// The 6-connected parts of the inside, or of equal labels, on the device.
#pragma once

#include "grow/growth_state.h"

namespace sherd {

/// Nodes and their parts, as kernels/components.cl makes them.
struct NodeParts {
  DeviceBuffer localNode;            ///< [items*512] ushort
  DeviceBuffer nodeCount;            ///< [items]
  DeviceBuffer firstNode;            ///< [items]
  DeviceBuffer root;                 ///< [nodes] lowest node of the part
  std::vector<cl_uint> nodesOfItem;  ///< nodeCount, on the host
  std::vector<cl_uint> first;        ///< firstNode, on the host
  cl_uint nodes = 0;
};

/// Find the parts; with `labels` [items*512], the parts of voxels of equal label.
[[nodiscard]] NodeParts findNodeParts(GrowthState& state, const DeviceBuffer* labels = nullptr);

/// Parts of equal labels that stay.
struct KeptParts {
  DeviceBuffer mask;           ///< [items*8] their voxels
  std::vector<cl_uint> freed;  ///< [fractures] inside voxels in no such part
  bool all() const;            ///< nothing was freed
};

/// The parts that hold a primary seed.
[[nodiscard]] KeptParts keepSeededParts(GrowthState& state, const DeviceBuffer& labels,
                                        const SeedTable& seeds);

/// The largest part of each label; of equal ones the first.
[[nodiscard]] KeptParts keepLargestParts(GrowthState& state, const DeviceBuffer& labels);

}  // namespace sherd
