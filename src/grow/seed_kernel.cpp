// Host side of kernels that give each voxel one of the seeds.
#include "grow/seed_kernel.h"

#include <algorithm>
#include <numeric>

#include "grow/metric.h"
#include "grow/ways_on_device.h"

namespace sherd {

Grown growByKernel(GrowthState& state, const SeedTable& seeds, const char* kernel,
                   const sherd_metric& metric,
                   std::span<const std::shared_ptr<const WallMiddles>> walls, bool keepCost) {
  std::vector<std::size_t> order(seeds.item.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto fractureOf = [&](std::size_t i) { return seeds.item[i] / state.leafCount; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(fractureOf(a), seeds.label[a]) < std::pair(fractureOf(b), seeds.label[b]);
  });
  // Steps of seeds have 32 bits in kernels, so positions are relative to the leaves.
  const openvdb::Coord lowest = state.lowest();
  const DeviceBuffer origins = state.uploadOrigins(lowest);
  std::vector<Int4> point;
  std::vector<std::int64_t> weight;
  std::vector<std::uint32_t> first(state.fractures + 1, 0);
  for (const std::size_t i : order) {
    const Seed seed{seedVoxel(state, seeds, i) - lowest, seeds.label[i], seeds.shift[i]};
    const glm::ivec3 at(stepsOf(seed));
    point.push_back({at.x, at.y, at.z, seed.fragment});
    weight.push_back(weightIn(metric, seeds.weight[i]));
    ++first[fractureOf(i) + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  const DeviceBuffer points = uploadBuffer<Int4>(state.device, point);
  const DeviceBuffer weights = uploadBuffer<std::int64_t>(state.device, weight);
  const DeviceBuffer firsts = uploadBuffer<std::uint32_t>(state.device, first);
  const WaysOnDevice ways = uploadWays(state, walls);
  Grown grown{makeLabels(state),
              makeBuffer<std::uint32_t>(state.device, keepCost ? state.voxels() : 1)};
  state.run(kernel, state.items, state.inside, origins, state.leafCount, state.items, points,
            weights, firsts, metric, ways.way, ways.isUsed, grown.labels.owner, grown.labels.tag,
            grown.labels.second, grown.cost, static_cast<std::uint32_t>(keepCost));
  state.device.finish();  // the seeds' buffers are released here
  return grown;
}

}  // namespace sherd
