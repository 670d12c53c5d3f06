// Flood growth on the device.  Method: kernels/flood.cl.
#include "grow/flood.h"

namespace sherd {

Flood::Flood(GrowthState& state, bool keepCost, int neighbors)
    : state_(state),
      keepCost_(keepCost ? 1 : 0),
      neighbors_(static_cast<cl_uint>(neighbors)),
      neighbors27_(neighbors == 26 ? state.neighbors27() : makeBuffer<cl_uint>(state.device, 1)),
      domain_(state.inside),
      beyond_(makeBuffer<cl_ulong>(state.device, std::size_t{state.leafCount} * SHERD_LEAF_FACES)),
      owned_(state.filled<cl_ulong>(state.words(), 0)),
      tag_(state.filled<cl_uint>(state.items, 0)),
      second_(makeBuffer<cl_ulong>(state.device, 3 * state.words())),
      owner_(makeBuffer<cl_ushort>(state.device, state.voxels())),
      fronts_(state.filled<cl_ulong>(2 * std::size_t{state.items} * SHERD_FRONT_WORDS,
                                     ~cl_ulong{0})),  // step = SHERD_NO_STEP
      queued_(state.filled<cl_uint>(state.items, SHERD_NO_STEP)),
      list_(makeBuffer<cl_uint>(state.device, 2 * std::size_t{state.items})),
      listCount_(state.filled<cl_uint>(3, 0)),
      cost_(keepCost ? state.filled<cl_uint>(state.voxels(), 0)
                     : makeBuffer<cl_uint>(state.device, 1)) {}

void Flood::seed(const SeedTable& table) {
  launch("flood_enter", state_.leafCount);
  const SeedGroups seeds = groupsOf(state_, table);
  const DeviceBuffer label = uploadBuffer<cl_ushort>(state_.device, table.label);
  launch("flood_seed", seeds.count, seeds.item, seeds.first, seeds.offset, label, seeds.count);
  state_.device.queue.finish();  // the seeds' buffers are released here
  seeded_ = true;
}

void Flood::load(const DeviceBuffer& labels, const DeviceBuffer& kept) {
  owner_ = labels;
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
  cl::Kernel kernel = state_.device.kernel("flood_step");
  const cl_uint stepArgument = setState(kernel);
  for (std::uint32_t done = 0; done < steps;) {
    for (std::uint32_t k = 0; k < perReadback && done < steps; ++k, ++done) {
      ++step_;
      kernel.setArg(stepArgument, step_);
      state_.launch(kernel, state_.items);
    }
    cl_uint listCount[3];
    readBuffer<cl_uint>(state_.device, listCount_, listCount);
    reportProgress(progress, "grow", 0.0);
    if (listCount[(step_ + 1) % 3] == 0) break;
  }
}

DeviceBuffer Flood::labels() {
  launch("flood_finish", state_.items);
  return owner_;
}

std::vector<std::uint16_t> Flood::read(cl_uint first, cl_uint count) {
  constexpr cl_uint kLeavesPerChunk = 4096;  // 4 MiB stay in a CPU's cache until they are read
  const DeviceBuffer chunk = makeBuffer<cl_ushort>(
      state_.device, std::size_t{std::min(kLeavesPerChunk, count)} * SHERD_LEAF_SIZE);
  std::vector<std::uint16_t> all;
  all.reserve(std::size_t{count} * SHERD_LEAF_SIZE);
  for (cl_uint done = 0; done < count; done += kLeavesPerChunk) {
    const cl_uint leaves = std::min(kLeavesPerChunk, count - done);
    launch("flood_show", leaves, first + done, leaves, chunk);
    append(all, state_.device, chunk, std::size_t{leaves} * SHERD_LEAF_SIZE);
  }
  return all;
}

// Sets the arguments of FLOOD_STATE in order; returns the index of the next one.
cl_uint Flood::setState(cl::Kernel& kernel) {
  cl_uint i = 0;
  const auto set = [&](const auto&... argument) {
    (kernel.setArg(i++, sherd::argument(argument)), ...);
  };
  set(domain_, state_.neighbor, neighbors27_, neighbors_, state_.leafCount, beyond_, owned_, tag_,
      second_, owner_, fronts_, queued_, list_, listCount_, state_.items, cost_, keepCost_);
  return i;
}

template <class... Arguments>
void Flood::launch(const char* name, std::size_t work, const Arguments&... arguments) {
  cl::Kernel kernel = state_.device.kernel(name);
  cl_uint i = setState(kernel);
  (kernel.setArg(i++, argument(arguments)), ...);
  state_.launch(kernel, work);
}

}  // namespace sherd
