// Flood growth on the device.  Method: kernels/flood.cl.
#include "grow/fields/flood.h"

namespace sherd {

Flood::Flood(GrowthState& state, bool keepCost, int neighbors)
    : state_(state),
      keepCost_(keepCost ? 1 : 0),
      neighbors_(static_cast<std::uint32_t>(neighbors)),
      neighbors27_(neighbors == 26 ? state.neighbors27()
                                   : makeBuffer<std::uint32_t>(state.device, 1)),
      domain_(state.inside),
      beyond_(
          makeBuffer<std::uint64_t>(state.device, std::size_t{state.leafCount} * SHERD_LEAF_FACES)),
      owned_(state.filled<std::uint64_t>(state.words(), 0)),
      tag_(state.filled<std::uint32_t>(state.items, 0)),
      second_(makeBuffer<std::uint64_t>(state.device, 3 * state.words())),
      owner_(makeBuffer<std::uint16_t>(state.device, state.voxels())),
      fronts_(state.filled<std::uint64_t>(2 * std::size_t{state.items} * SHERD_FRONT_WORDS,
                                          ~std::uint64_t{0})),  // step = SHERD_NO_STEP
      queued_(state.filled<std::uint32_t>(state.items, SHERD_NO_STEP)),
      list_(makeBuffer<std::uint32_t>(state.device, 2 * std::size_t{state.items})),
      listCount_(state.filled<std::uint32_t>(3, 0)),
      cost_(keepCost ? state.filled<std::uint32_t>(state.voxels(), 0)
                     : makeBuffer<std::uint32_t>(state.device, 1)) {}

void Flood::seed(const SeedTable& table) {
  launch("flood_enter", state_.leafCount);
  const SeedGroups seeds = groupsOf(state_, table);
  const DeviceBuffer label = uploadBuffer<std::uint16_t>(state_.device, table.label);
  launch("flood_seed", seeds.count, seeds.item, seeds.first, seeds.offset, label, seeds.count);
  state_.device.finish();  // the seeds' buffers are released here
  seeded_ = true;
}

void Flood::load(const DeviceLabels& labels, const DeviceBuffer& kept) {
  owner_ = labels.owner;
  tag_ = labels.tag;
  second_ = labels.second;
  launch("flood_load", state_.items, kept);
  seeded_ = false;
}

void Flood::grow(const DeviceBuffer& domain, std::uint32_t steps, std::uint32_t perReadback,
                 const Progress* progress) {
  domain_ = domain;
  if (!seeded_) {
    launch("flood_enter", state_.leafCount);
    launch("flood_restart", state_.items, step_);
  }
  seeded_ = false;
  for (std::uint32_t done = 0; done < steps;) {
    for (std::uint32_t k = 0; k < perReadback && done < steps; ++k, ++done) {
      launch("flood_step", state_.items, ++step_);
    }
    std::uint32_t listCount[3];
    readBuffer<std::uint32_t>(state_.device, listCount_, listCount);
    reportProgress(progress, "grow", 0.0);
    if (listCount[(step_ + 1) % 3] == 0) break;
  }
}

DeviceLabels Flood::labels() {
  launch("flood_finish", state_.items);
  return labelsPerVoxel(state_, owner_);
}

std::vector<std::uint16_t> Flood::read(std::uint32_t first, std::uint32_t count) {
  constexpr std::uint32_t kLeavesPerChunk =
      4096;  // 4 MiB stay in a CPU's cache until they are read
  const DeviceBuffer chunk = makeBuffer<std::uint16_t>(
      state_.device, std::size_t{std::min(kLeavesPerChunk, count)} * SHERD_LEAF_SIZE);
  std::vector<std::uint16_t> all;
  all.reserve(std::size_t{count} * SHERD_LEAF_SIZE);
  for (std::uint32_t done = 0; done < count; done += kLeavesPerChunk) {
    const std::uint32_t leaves = std::min(kLeavesPerChunk, count - done);
    launch("flood_show", leaves, first + done, leaves, chunk);
    appendDownloaded(all, state_.device, chunk, std::size_t{leaves} * SHERD_LEAF_SIZE);
  }
  return all;
}

template <class... Arguments>
void Flood::launch(const char* name, std::size_t work, const Arguments&... arguments) {
  state_.run(name, work, domain_, state_.neighbor, neighbors27_, neighbors_, state_.leafCount,
             beyond_, owned_, tag_, second_, owner_, fronts_, queued_, list_, listCount_,
             state_.items, cost_, keepCost_, arguments...);
}

}  // namespace sherd
