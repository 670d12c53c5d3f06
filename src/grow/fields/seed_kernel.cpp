// Host side of kernels that give each voxel one of the seeds.
#include "grow/fields/seed_kernel.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "grow/fields/metric.h"
#include "grow/fields/ways_on_device.h"

namespace sherd {
namespace {

// The items of some fractures and leaves, which a kernel runs over at once.
struct Part {
  std::uint32_t firstFracture = 0, fractures = 0, firstLeaf = 0, leaves = 0;

  [[nodiscard]] std::uint32_t items() const { return fractures * leaves; }
};

struct SeedsOnDevice {
  DeviceBuffer point, weight, first;
};

// Runs a kernel over all leaves, or over those of each layer with the seeds in it.
class SeedKernel {
 public:
  SeedKernel(GrowthState& state, const SeedTable& seeds, const char* kernel,
             const sherd_metric& metric, bool keepCost)
      : state_(state),
        seeds_(seeds),
        kernel_(kernel),
        metric_(metric),
        keepCost_(keepCost),
        lowest_(state.lowest()),
        order_(seeds.item.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(fractureOf(a), seeds.label[a]) < std::pair(fractureOf(b), seeds.label[b]);
    });
  }

  Grown overAll(const WaysOnDevice& ways) {
    const Part all{0, state_.fractures, 0, state_.leafCount};
    return over(all, state_.inside, state_.uploadOrigins(lowest_), ways);
  }

  // Without this, cells would lose voxels to seeds beyond gaps, and where bodies touch.
  Grown overLayers(const WallWays& walls) {
    Grown grown{makeLabels(state_),
                makeBuffer<std::uint32_t>(state_.device, keepCost_ ? state_.voxels() : 1)};
    const std::span<const std::uint32_t> first = state_.firstOfLayer();
    for (std::size_t layer = 0; layer + 1 < first.size(); ++layer) {
      if (first[layer] == first[layer + 1]) continue;
      const Part leaves{0, 1, first[layer], first[layer + 1] - first[layer]};
      const DeviceBuffer inside = uploadBuffer<std::uint64_t>(
          state_.device, std::span<const std::uint64_t>(state_.blocks.inside)
                             .subspan(std::size_t{leaves.firstLeaf} * SHERD_LEAF_WORDS,
                                      std::size_t{leaves.leaves} * SHERD_LEAF_WORDS));
      const DeviceBuffer origins = originsOf(leaves);
      for (std::uint32_t f = 0; f < state_.fractures; ++f) {
        Part part = leaves;
        part.firstFracture = f;
        const WaysOnDevice ways = walls.uploaded(state_.device, f, leaves.firstLeaf, leaves.leaves);
        copy(over(part, inside, origins, ways), part, grown);
      }
    }
    return grown;
  }

 private:
  [[nodiscard]] std::uint32_t fractureOf(std::size_t i) const {
    return seeds_.item[i] / state_.leafCount;
  }

  [[nodiscard]] bool isIn(const Part& part, std::size_t i) const {
    const std::uint32_t fracture = fractureOf(i), leaf = seeds_.item[i] % state_.leafCount;
    return fracture - part.firstFracture < part.fractures && leaf - part.firstLeaf < part.leaves;
  }

  // Steps of seeds have 32 bits in kernels, so positions are relative to the leaves.
  [[nodiscard]] SeedsOnDevice upload(const Part& part) const {
    std::vector<Int4> point;
    std::vector<std::int64_t> weight;
    std::vector<std::uint32_t> first(part.fractures + std::size_t{1}, 0);
    for (const std::size_t i : order_) {
      if (!isIn(part, i)) continue;
      const Seed seed{seedVoxel(state_, seeds_, i) - lowest_, seeds_.label[i], seeds_.shift[i]};
      const glm::ivec3 at(stepsOf(seed));
      point.push_back({at.x, at.y, at.z, seed.fragment});
      weight.push_back(weightIn(metric_, seeds_.weight[i]));
      ++first[fractureOf(i) - part.firstFracture + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    return {uploadBuffer<Int4>(state_.device, point),
            uploadBuffer<std::int64_t>(state_.device, weight),
            uploadBuffer<std::uint32_t>(state_.device, first)};
  }

  [[nodiscard]] DeviceBuffer originsOf(const Part& part) const {
    std::vector<Int4> origins;
    for (std::uint32_t leaf = 0; leaf < part.leaves; ++leaf) {
      const openvdb::Coord at = state_.blocks.origins[part.firstLeaf + leaf] - lowest_;
      origins.push_back({at.x(), at.y(), at.z(), 0});
    }
    return uploadBuffer<Int4>(state_.device, origins);
  }

  //   inside, origins  of the part's leaves
  Grown over(const Part& part, const DeviceBuffer& inside, const DeviceBuffer& origins,
             const WaysOnDevice& ways) {
    const SeedsOnDevice seeds = upload(part);
    const std::size_t items = part.items(), voxels = items * SHERD_LEAF_SIZE;
    Grown grown{makeLabels(state_.device, items),
                makeBuffer<std::uint32_t>(state_.device, keepCost_ ? voxels : 1)};
    state_.run(kernel_, items, inside, origins, part.leaves, part.items(), seeds.point,
               seeds.weight, seeds.first, metric_, ways.way, ways.isUsed, grown.labels.owner,
               grown.labels.tag, grown.labels.second, grown.cost,
               static_cast<std::uint32_t>(keepCost_));
    state_.device.finish();  // the seeds' buffers are released here
    return grown;
  }

  void copy(const Grown& from, const Part& part, Grown& to) {
    const std::size_t first = std::size_t{part.firstFracture} * state_.leafCount + part.firstLeaf;
    const auto copied = [&](const DeviceBuffer& own, const DeviceBuffer& all, std::size_t bytes) {
      state_.device.copy(*own, *all, first * bytes, part.items() * bytes);
    };
    copied(from.labels.owner, to.labels.owner, sizeof(std::uint16_t) * SHERD_LEAF_SIZE);
    copied(from.labels.tag, to.labels.tag, sizeof(std::uint32_t));
    copied(from.labels.second, to.labels.second, sizeof(std::uint64_t) * 3 * SHERD_LEAF_WORDS);
    if (keepCost_) copied(from.cost, to.cost, sizeof(std::uint32_t) * SHERD_LEAF_SIZE);
    state_.device.finish();  // the part's buffers are released here
  }

  GrowthState& state_;
  const SeedTable& seeds_;
  const char* const kernel_;
  const sherd_metric& metric_;
  const bool keepCost_;
  const openvdb::Coord lowest_;
  std::vector<std::size_t> order_;  // by fracture, then by label
};

}  // namespace

Grown growByKernel(GrowthState& state, const SeedTable& seeds, const char* kernel,
                   const sherd_metric& metric,
                   std::span<const std::shared_ptr<const WallMiddles>> walls, bool keepCost) {
  SeedKernel seedKernel(state, seeds, kernel, metric, keepCost);
  const WallWays ways(state, walls);
  if (state.apart != nullptr) return seedKernel.overLayers(ways);
  return seedKernel.overAll(ways.uploaded(state.device));
}

}  // namespace sherd
