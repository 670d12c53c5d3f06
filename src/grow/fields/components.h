// 6-connected components of the inside, or of equal labels, on the device.
#pragma once

#include "grow/fields/growth_state.h"

namespace sherd {

/// Nodes and their components, see kernels/components.cl.
struct NodeComponents {
  DeviceBuffer localNode;                  ///< [items*512] ushort
  DeviceBuffer nodeCount;                  ///< [items]
  DeviceBuffer firstNode;                  ///< [items]
  DeviceBuffer root;                       ///< [nodes] lowest node of the component
  std::vector<std::uint32_t> nodesOfItem;  ///< nodeCount, on the host
  std::vector<std::uint32_t> first;        ///< firstNode, on the host
  std::uint32_t nodes = 0;
};

/// Find the nodes alone: `root` is not set.
[[nodiscard]] NodeComponents findNodes(GrowthState& state, const DeviceLabels* labels = nullptr);

/// Find the components; with `labels`, those of voxels of equal label.
[[nodiscard]] NodeComponents findNodeComponents(GrowthState& state,
                                                const DeviceLabels* labels = nullptr);

/// Components of equal labels that keep their label.
struct KeptComponents {
  DeviceBuffer mask;                        ///< [items*8] their voxels
  std::vector<std::uint32_t> disconnected;  ///< [fractures] inside voxels in no kept component
  bool all() const;                         ///< whether no voxel is disconnected
};

/// Keep the components that contain a primary seed.
[[nodiscard]] KeptComponents keepSeededComponents(GrowthState& state, const DeviceLabels& labels,
                                                  const SeedTable& seeds);

/// Keep the largest component of each label; of equally large ones the first.
[[nodiscard]] KeptComponents keepLargestComponents(GrowthState& state, const DeviceLabels& labels);

}  // namespace sherd
