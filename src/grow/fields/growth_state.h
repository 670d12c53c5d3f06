// The device state that all growths share: leaf blocks, and kernel launches over them.
#pragma once

#include <sherd/labels.h>

#include <optional>
#include <span>
#include <vector>

#include "cl/device_impl.h"
#include "cl/int4.h"
#include "grow/fields/apart_leaves.h"
#include "leaf_block.h"

namespace sherd {

/// Leaf blocks on the device, for several fractures at once: item = fracture * leaves + leaf.
class GrowthState {
 public:
  ///   throws  Error(usage) more than 2^32 - 2 items
  ///   apart   null, or what the blocks are those of: layers apart; kept by reference
  GrowthState(const LeafBlocks& blocks, std::size_t fractures, DeviceImpl& device,
              int workGroupSize = 0, const ApartLeaves* apart = nullptr);

  DeviceImpl& device;
  const LeafBlocks& blocks;
  const ApartLeaves* apart;  ///< null: one layer
  const std::uint32_t leafCount, fractures, items;
  const DeviceBuffer inside;    ///< [leafCount*8]
  const DeviceBuffer neighbor;  ///< [leafCount*6]

  const DeviceBuffer& origin();  ///< [leafCount] int4

  /// Returns the lowest coordinates of all leaves.
  openvdb::Coord lowest() const;

  /// Returns ApartLeaves::firstOfLayer, empty for one layer.
  std::span<const std::uint32_t> firstOfLayer() const {
    return apart != nullptr ? std::span<const std::uint32_t>(apart->firstOfLayer)
                            : std::span<const std::uint32_t>();
  }

  /// Uploads [leafCount] int4: origins as seen from a voxel.
  DeviceBuffer uploadOrigins(const openvdb::Coord& from) const;
  const DeviceBuffer& neighbors27();  ///< [leafCount*27] 26-neighborhood of a leaf, x slowest

  std::size_t voxels() const { return std::size_t{items} * SHERD_LEAF_SIZE; }
  std::size_t words() const { return std::size_t{items} * SHERD_LEAF_WORDS; }

  template <class T>
  DeviceBuffer filled(std::size_t count, T value) {
    DeviceBuffer buffer = makeBuffer<T>(device, count);
    fillBuffer(device, buffer, count, value);
    return buffer;
  }

  /// Launch the kernel `name` over `work` elements.
  template <class... Arguments>
  void run(const char* name, std::size_t work, const Arguments&... arguments) {
    launchKernel(device, name, work, group_, arguments...);
  }
  int workGroupSize() const { return static_cast<int>(group_); }

 private:
  std::size_t group_;
  std::optional<DeviceBuffer> origin_, neighbors27_;
};

/// Labels of all items on the device, per leaf where it has one or two: kernels/leaf_labels.h.
struct DeviceLabels {
  DeviceBuffer owner;   ///< [items*512] ushort
  DeviceBuffer tag;     ///< [items] uint
  DeviceBuffer second;  ///< [items*3*8] ulong
};

/// Returns buffers for labels, uninitialized.
[[nodiscard]] DeviceLabels makeLabels(GrowthState& state);
[[nodiscard]] DeviceLabels makeLabels(DeviceImpl& device, std::size_t items);

/// Returns labels that are all stored per voxel.
///   owner  [items*512]
[[nodiscard]] DeviceLabels labelsPerVoxel(GrowthState& state, const DeviceBuffer& owner);

/// Seeds of all fractures, ascending by item and offset; of two on one voxel the lower label.
struct SeedTable {
  std::vector<std::uint32_t> item;
  std::vector<std::uint16_t> offset, label;
  std::vector<glm::ivec3> shift;
  std::vector<std::int64_t> weight;
  std::vector<bool> primary;  ///< the first of its fragment in its seed set
};

/// Seeds on the device, grouped by item, for kernels with one work-item per item.
struct SeedGroups {
  DeviceBuffer item;    ///< [count] items with seeds, ascending
  DeviceBuffer first;   ///< [count+1] index of an item's first seed
  DeviceBuffer offset;  ///< [seeds]
  std::uint32_t count = 0;
};

/// The first seed of each fragment on the device.
struct PrimarySeeds {
  DeviceBuffer item, offset, label;  ///< [count]
  std::uint32_t count = 0;
};

[[nodiscard]] SeedGroups groupsOf(GrowthState& state, const SeedTable& seeds);
[[nodiscard]] PrimarySeeds primariesOf(GrowthState& state, const SeedTable& seeds);

/// Voxel of seed i of the table.
[[nodiscard]] openvdb::Coord seedVoxel(const GrowthState& state, const SeedTable& seeds,
                                       std::size_t i);

///   firstOfLayer  see ApartLeaves
///   throws        Error(usage) a seed outside the solid, or of fragment 0
[[nodiscard]] SeedTable tableOf(const LeafBlocks& blocks,
                                std::span<const std::vector<Seed>> seedSets,
                                std::span<const std::uint32_t> firstOfLayer = {});

}  // namespace sherd
