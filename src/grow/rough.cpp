// Driving kernels/rough.cl.
#include "grow/rough.h"

namespace sherd {

cl::Buffer roughened(GrowthState& state, const cl::Buffer& labels, const SeedTable& seeds,
                     std::span<const std::uint64_t> noiseSeeds,
                     std::span<const cl_int> amplitudes) {
  const cl::Buffer noise = uploadBuffer<std::uint64_t>(state.device, noiseSeeds);
  const cl::Buffer amplitude = uploadBuffer<cl_int>(state.device, amplitudes);
  const cl::Buffer out = makeBuffer<cl_ushort>(state.device, state.voxels());
  state.run("rough.cl", "rough", state.items, state.inside, state.neighbour, state.origin(),
            state.leafCount, state.items, noise, amplitude, static_cast<cl_int>(amplitudes.size()),
            labels, out);

  const PrimarySeeds primaries = primariesOf(state, seeds);
  state.run("rough.cl", "rough_pin", primaries.count, primaries.item, primaries.offset,
            primaries.label, primaries.count, out);
  state.device.queue.finish();  // the buffers made here end here
  return out;
}

}  // namespace sherd
