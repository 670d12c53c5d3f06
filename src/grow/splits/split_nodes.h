// The nodes of connected components on the device, with their labels and sums, on the host.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "grow/fields/components.h"
#include "grow/sized/split_plan.h"

namespace sherd {

/// Nodes: the voxels of one label in a leaf that are connected there, see kernels/split.cl.
class SplitNodes {
 public:
  /// Measures the nodes of labels, and finds their components.
  SplitNodes(GrowthState& state, const DeviceLabels& labels)
      : SplitNodes(state, labels, findNodeComponents(state, &labels)) {
    root_ = downloaded<std::uint32_t>(state.device, found_.root, found_.nodes);
  }

  /// Measures the nodes of labels; their components are not known.
  [[nodiscard]] static SplitNodes withoutRoots(GrowthState& state, const DeviceLabels& labels) {
    return {state, labels, findNodes(state, &labels)};
  }

  std::uint32_t count() const { return found_.nodes; }
  std::uint32_t root(std::size_t node) const { return root_[node]; }
  std::uint16_t label(std::size_t node) const { return sums_[node * kSums + 10]; }
  VoxelSums sums(std::size_t node) const;
  std::uint32_t voxels(std::size_t node) const { return sums_[node * kSums]; }

  /// The nodes [first, last) of a fracture's leaf.
  std::pair<std::uint32_t, std::uint32_t> of(std::size_t item) const {
    return {found_.first[item], found_.first[item] + found_.nodesOfItem[item]};
  }

  /// Returns pairs of components that touch, by their roots, ascending, each once.
  ///   piece  [count()] of each node, 0: not asked for; components of different pieces are no pair
  [[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> contacts(
      GrowthState& state, std::span<const std::uint32_t> piece) const;

  /// Gives nodes new labels, here and on the device.
  ///   label  [count()]
  void relabel(GrowthState& state, const DeviceLabels& labels,
               std::span<const std::uint16_t> label);

  /// Finds the voxels of nodes that are nearest to positions, relative to their leaves.
  struct Target {
    std::uint32_t item = 0, node = 0;  ///< counted from the item's first
    glm::ivec3 position{0};
  };
  [[nodiscard]] std::vector<std::uint16_t> nearestVoxels(GrowthState& state,
                                                         std::span<const Target> targets) const;

 private:
  static constexpr std::size_t kSums = 12;

  SplitNodes(GrowthState& state, const DeviceLabels& labels, NodeComponents found);

  NodeComponents found_;
  std::vector<std::uint32_t> root_;  // [nodes]
  std::vector<std::uint16_t> sums_;  // [nodes*kSums]
};

}  // namespace sherd
