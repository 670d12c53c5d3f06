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

  std::vector<cl_uint> item;
  std::vector<cl_ushort> offset, label;
  for (std::size_t i = 0; i < seeds.item.size(); ++i) {
    if (!seeds.primary[i]) continue;
    item.push_back(seeds.item[i]);
    offset.push_back(seeds.offset[i]);
    label.push_back(seeds.label[i]);
  }
  const cl::Buffer items = uploadBuffer<cl_uint>(state.device, item);
  const cl::Buffer offsets = uploadBuffer<cl_ushort>(state.device, offset);
  const cl::Buffer ids = uploadBuffer<cl_ushort>(state.device, label);
  state.run("rough.cl", "rough_pin", item.size(), items, offsets, ids,
            static_cast<cl_uint>(item.size()), out);
  state.device.queue.finish();  // the buffers made here end here
  return out;
}

}  // namespace sherd
