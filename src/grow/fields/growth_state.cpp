// Leaf blocks and seeds as device buffers.
#include "grow/fields/growth_state.h"

#include <sherd/error.h>

#include <map>
#include <set>
#include <string>

namespace sherd {
namespace {

std::uint32_t itemsOf(const LeafBlocks& blocks, std::size_t fractures) {
  const std::size_t items = blocks.count() * fractures;
  if (items >= SHERD_NO_LEAF) {
    throw Error(ErrorCode::usage, "the batch holds " + std::to_string(items) + " leaves, at most " +
                                      std::to_string(SHERD_NO_LEAF - 1) + " can grow together");
  }
  return static_cast<std::uint32_t>(items);
}

}  // namespace

GrowthState::GrowthState(const LeafBlocks& b, std::size_t fractureCount, DeviceImpl& d,
                         int workGroupSize, const ApartLeaves* apartOf)
    : device(d),
      blocks(b),
      apart(apartOf),
      leafCount(static_cast<std::uint32_t>(b.count())),
      fractures(static_cast<std::uint32_t>(fractureCount)),
      items(itemsOf(b, fractureCount)),
      inside(uploadBuffer<std::uint64_t>(d, b.inside)),
      neighbor(uploadBuffer<std::uint32_t>(d, b.neighbors)),
      group_(workGroupSize > 0 ? static_cast<std::size_t>(workGroupSize) : d.workGroupSize()) {}

DeviceBuffer GrowthState::uploadOrigins(const openvdb::Coord& from) const {
  std::vector<Int4> origins;
  origins.reserve(leafCount);
  for (const openvdb::Coord& origin : blocks.origins) {
    const openvdb::Coord o = origin - from;
    origins.push_back({o.x(), o.y(), o.z(), 0});
  }
  return uploadBuffer<Int4>(device, origins);
}

const DeviceBuffer& GrowthState::origin() {
  if (!origin_) origin_ = uploadOrigins(openvdb::Coord(0));
  return *origin_;
}

openvdb::Coord GrowthState::lowest() const {
  openvdb::Coord low = blocks.origins.empty() ? openvdb::Coord(0) : blocks.origins.front();
  for (const openvdb::Coord& origin : blocks.origins) low.minComponent(origin);
  return low;
}

const DeviceBuffer& GrowthState::neighbors27() {
  if (!neighbors27_) {
    neighbors27_ =
        uploadBuffer<LeafNeighbors>(device, leafNeighbors(blocks.origins, firstOfLayer()));
  }
  return *neighbors27_;
}

DeviceLabels makeLabels(DeviceImpl& device, std::size_t items) {
  return {makeBuffer<std::uint16_t>(device, items * SHERD_LEAF_SIZE),
          makeBuffer<std::uint32_t>(device, items),
          makeBuffer<std::uint64_t>(device, 3 * items * SHERD_LEAF_WORDS)};
}

DeviceLabels makeLabels(GrowthState& state) { return makeLabels(state.device, state.items); }

DeviceLabels labelsPerVoxel(GrowthState& state, const DeviceBuffer& owner) {
  return {owner, state.filled<std::uint32_t>(state.items, SHERD_TAG_MIXED),
          makeBuffer<std::uint64_t>(state.device, 3 * state.words())};
}

SeedTable tableOf(const LeafBlocks& blocks, std::span<const std::vector<Seed>> seedSets,
                  std::span<const std::uint32_t> firstOfLayer) {
  struct Entry {
    std::uint16_t label;
    bool primary;
    glm::ivec3 shift;
    std::int64_t weight;
  };
  std::map<std::pair<std::uint64_t, std::uint32_t>, Entry> sorted;
  for (std::size_t f = 0; f < seedSets.size(); ++f) {
    std::set<std::uint16_t> seen;
    for (const Seed& seed : seedSets[f]) {
      const std::size_t voxel = findInside(blocks, firstOfLayer, seed.voxel);
      if (voxel == kNoVoxel || seed.fragment == 0) {
        throw Error(ErrorCode::usage, "seed of fragment " + std::to_string(seed.fragment) +
                                          " does not lie on a voxel of the solid");
      }
      const Entry entry{seed.fragment, seen.insert(seed.fragment).second, seed.shift, seed.weight};
      const auto [at, added] = sorted.try_emplace(
          {f * blocks.count() + voxel / 512, static_cast<std::uint32_t>(voxel % 512)}, entry);
      if (!added && entry.label < at->second.label) at->second = entry;
    }
  }
  SeedTable table;
  for (const auto& [key, entry] : sorted) {
    table.item.push_back(static_cast<std::uint32_t>(key.first));
    table.offset.push_back(static_cast<std::uint16_t>(key.second));
    table.label.push_back(entry.label);
    table.shift.push_back(entry.shift);
    table.weight.push_back(entry.weight);
    table.primary.push_back(entry.primary);
  }
  return table;
}

SeedGroups groupsOf(GrowthState& state, const SeedTable& seeds) {
  std::vector<std::uint32_t> item, first;
  for (std::size_t i = 0; i < seeds.item.size(); ++i) {
    if (!item.empty() && item.back() == seeds.item[i]) continue;
    item.push_back(seeds.item[i]);
    first.push_back(static_cast<std::uint32_t>(i));
  }
  first.push_back(static_cast<std::uint32_t>(seeds.item.size()));
  return {uploadBuffer<std::uint32_t>(state.device, item),
          uploadBuffer<std::uint32_t>(state.device, first),
          uploadBuffer<std::uint16_t>(state.device, seeds.offset),
          static_cast<std::uint32_t>(item.size())};
}

PrimarySeeds primariesOf(GrowthState& state, const SeedTable& seeds) {
  std::vector<std::uint32_t> item;
  std::vector<std::uint16_t> offset, label;
  for (std::size_t i = 0; i < seeds.item.size(); ++i) {
    if (!seeds.primary[i]) continue;
    item.push_back(seeds.item[i]);
    offset.push_back(seeds.offset[i]);
    label.push_back(seeds.label[i]);
  }
  return {uploadBuffer<std::uint32_t>(state.device, item),
          uploadBuffer<std::uint16_t>(state.device, offset),
          uploadBuffer<std::uint16_t>(state.device, label),
          static_cast<std::uint32_t>(item.size())};
}

openvdb::Coord seedVoxel(const GrowthState& state, const SeedTable& seeds, std::size_t i) {
  return state.blocks.origins[seeds.item[i] % state.leafCount] + coordFromOffset(seeds.offset[i]);
}

}  // namespace sherd
