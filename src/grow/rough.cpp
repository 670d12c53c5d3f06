// Driving kernels/rough.cl.
#include "grow/rough.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace sherd {
namespace {

// How many leaves away a walk can end.
cl_uint leavesReached(std::span<const cl_int> amplitudes) {
  std::int64_t most = 128;  // 1/256 voxels, rounded to the nearest voxel
  for (const cl_int amplitude : amplitudes) most += std::abs(std::int64_t{amplitude}) + 1;
  return static_cast<cl_uint>((most / 256 + 7) / 8);
}

// What walks need to know of leaves.
struct Leaves {
  DeviceBuffer same;  // [items] rings of leaves, its own the first, with one label at most
  DeviceBuffer full;  // [items] inside throughout?
};

Leaves leavesOf(GrowthState& state, const DeviceBuffer& labels, cl_uint reach) {
  constexpr cl_uint kMostRings = 16;  // beyond, leaves count as near a crack
  Leaves leaves{state.filled<cl_uint>(state.items, 0),
                makeBuffer<cl_uint>(state.device, state.items)};
  DeviceBuffer single = makeBuffer<cl_uint>(state.device, state.items);
  DeviceBuffer wider = makeBuffer<cl_uint>(state.device, state.items);
  state.run("rough_leaves", state.items, state.inside, state.leafCount, state.items, labels, single,
            leaves.full);
  for (cl_uint ring = 0; ring <= std::min(reach, kMostRings); ++ring) {
    state.run("rough_rings", state.items, state.round27(), state.leafCount, state.items, ring,
              single, wider, leaves.same);
    std::swap(single, wider);
  }
  return leaves;
}

}  // namespace

DeviceBuffer roughened(GrowthState& state, const DeviceBuffer& labels, const SeedTable& seeds,
                       std::span<const std::uint64_t> noiseSeeds,
                       std::span<const cl_int> amplitudes) {
  const DeviceBuffer noise = uploadBuffer<std::uint64_t>(state.device, noiseSeeds);
  const DeviceBuffer amplitude = uploadBuffer<cl_int>(state.device, amplitudes);
  const DeviceBuffer out = makeBuffer<cl_ushort>(state.device, state.voxels());
  const Leaves leaves = leavesOf(state, labels, leavesReached(amplitudes));
  state.run("rough", state.items, state.inside, state.neighbour, state.round27(), state.origin(),
            state.leafCount, state.items, noise, amplitude, static_cast<cl_int>(amplitudes.size()),
            leaves.same, leaves.full, labels, out);

  const PrimarySeeds primaries = primariesOf(state, seeds);
  state.run("rough_pin", primaries.count, primaries.item, primaries.offset, primaries.label,
            primaries.count, out);
  state.device.queue.finish();  // the buffers made here end here
  return out;
}

}  // namespace sherd
