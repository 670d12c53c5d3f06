// Host side of kernels/levels.cl.
#include "grow/levels.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "voxelize/leaf_blocks.h"

namespace sherd {
namespace {

constexpr cl_uint kPassesPerReadback = 32;
constexpr cl_uint kBucketsPerVoxel = 2;  // of chain
constexpr std::size_t kControlWords = 11;

class Levels {
 public:
  explicit Levels(GrowthState& state)
      : state_(state),
        owned_(state.filled<cl_ulong>(state.words(), 0)),
        offered_(state.filled<cl_ulong>(state.words(), 0)),
        source_(makeBuffer<cl_uint>(state.device, state.voxels())),
        cost_(makeBuffer<cl_uint>(state.device, state.voxels())),
        claim_(state.filled<cl_ulong>(2 * state.words(), 0)),
        claimed_(state.filled<cl_uint>(2 * std::size_t{state.items}, 0)),
        wake_(state.filled<cl_uint>(state.items, SHERD_NO_STEP)),
        dirty_(state.filled<cl_uint>(state.items, 0)),
        queued_(state.filled<cl_uint>(state.items, 0)),
        list_(makeBuffer<cl_uint>(state.device, 2 * std::size_t{state.items})),
        taken_(makeBuffer<cl_uint>(state.device, state.items)) {
    std::array<cl_uint, kControlWords> control{};
    for (std::size_t i = 3; i < 6; ++i) control[i] = SHERD_NO_STEP;  // no offer waits
    control_ = uploadBuffer<cl_uint>(state.device, control);
  }

  void seed(const SeedTable& table, std::span<const cl_uint> source) {
    state_.device.queue.enqueueFillBuffer<cl_uint>(cost_, 0, 0, state_.voxels() * sizeof(cl_uint));
    const SeedGroups seeds = groupsOf(state_, table);
    const DeviceBuffer sources = uploadBuffer<cl_uint>(state_.device, source);
    launch("levels_seed", seeds.count, seeds.item, seeds.first, seeds.offset, sources, seeds.count);
    state_.device.queue.finish();  // the seeds' buffers are released here
  }

  void load(const DeviceBuffer& labels, const DeviceBuffer& kept) {
    launch("levels_keep", state_.items, kept);
    launch("levels_load", state_.items, labels);
  }

  // Writes into the labels passed to load().
  void save(const DeviceBuffer& labels, const DeviceBuffer& kept) {
    launch("levels_save", state_.items, kept, labels);
  }

  // `stride`, `metric` and `seeds`: see levels_take.
  void grow(const Steps& steps, bool chain, cl_uint stride, const sherd_metric& metric,
            const DeviceBuffer& seeds, const Progress* progress) {
    const DeviceBuffer stepBuffer = uploadBuffer<cl_int4>(state_.device, steps.step);
    const DeviceBuffer within = uploadBuffer<cl_int>(state_.device, steps.within);
    launch("levels_begin", state_.items);
    cl::Kernel take = state_.device.kernel("levels_take");
    cl::Kernel publish = state_.device.kernel("levels_publish");
    const cl_uint takePass = setState(take), publishPass = setState(publish);
    cl_uint i = takePass + 1;
    const auto set = [&](const auto&... argument) {
      (take.setArg(i++, sherd::argument(argument)), ...);
    };
    const auto count = static_cast<cl_uint>(steps.step.size());
    set(stepBuffer, within, count, static_cast<cl_uint>(chain), stride, metric, seeds,
        state_.origin());
    publish.setArg(publishPass + 1, count);
    for (cl_uint pass = 1;;) {
      for (cl_uint k = 0; k < kPassesPerReadback; ++k, ++pass) {
        take.setArg(takePass, pass);
        state_.launch(take, state_.items);
        publish.setArg(publishPass, pass);
        state_.launch(publish, state_.items);
      }
      std::array<cl_uint, kControlWords> control;
      readBuffer<cl_uint>(state_.device, control_, control);
      reportProgress(progress, "grow", 0.0);
      if (control[pass % 3] == 0) break;
    }
  }

  Grown finish(const DeviceBuffer& labelOfSource, bool chain) {
    Grown grown{makeBuffer<cl_ushort>(state_.device, state_.voxels()), cost_};
    launch("levels_finish", state_.items, labelOfSource, static_cast<cl_uint>(chain), grown.labels);
    return grown;
  }

 private:
  // Sets the arguments of LEVELS_STATE in order; returns the index of the next one.
  cl_uint setState(cl::Kernel& kernel) {
    cl_uint i = 0;
    const auto set = [&](const auto&... argument) {
      (kernel.setArg(i++, sherd::argument(argument)), ...);
    };
    set(state_.inside, state_.neighbors27(), state_.leafCount, state_.items, owned_, offered_,
        source_, cost_, claim_, claimed_, wake_, dirty_, queued_, list_, taken_, control_);
    return i;
  }

  template <class... Arguments>
  void launch(const char* name, std::size_t work, const Arguments&... arguments) {
    cl::Kernel kernel = state_.device.kernel(name);
    cl_uint i = setState(kernel);
    (kernel.setArg(i++, argument(arguments)), ...);
    state_.launch(kernel, work);
  }

  GrowthState& state_;
  DeviceBuffer owned_, offered_, source_, cost_, claim_, claimed_, wake_, dirty_, queued_, list_,
      taken_, control_;
};

void runByWeight(GrowthState& state, Levels& levels, const Steps& steps, const Progress* progress) {
  const DeviceBuffer none = makeBuffer<cl_int4>(state.device, 1);
  levels.grow(steps, false, steps.leastWeight, sherd_metric{}, none, progress);
}

// Returns the leaves with an inside voxel outside `kept` in any fracture, and the leaves around
// them: no other voxel makes or takes an offer.
std::vector<cl_uint> leavesToRegrow(const LeafBlocks& blocks, std::span<const cl_ulong> kept) {
  std::vector<bool> regrows(blocks.count()), reached(blocks.count());
  for (std::size_t word = 0; word < kept.size(); ++word) {
    const std::size_t leafWord = word % blocks.inside.size();
    if (blocks.inside[leafWord] & ~kept[word]) regrows[leafWord / SHERD_LEAF_WORDS] = true;
  }
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    if (!regrows[leaf]) continue;
    for (int k = 0; k < 27; ++k) {
      const openvdb::Coord offset(8 * (k / 9 - 1), 8 * (k / 3 % 3 - 1), 8 * (k % 3 - 1));
      const std::uint32_t around = findLeaf(blocks, blocks.origins[leaf] + offset);
      if (around != LeafBlocks::kNone) reached[around] = true;
    }
  }
  std::vector<cl_uint> leaves;
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    if (reached[leaf]) leaves.push_back(static_cast<cl_uint>(leaf));
  }
  return leaves;
}

// Returns the inside of some leaves.
LeafBlocks insideOf(const LeafBlocks& blocks, std::span<const cl_uint> leaves) {
  LeafBlocks some;
  for (const std::size_t leaf : leaves) {
    const auto word = blocks.inside.begin() + static_cast<std::ptrdiff_t>(leaf * SHERD_LEAF_WORDS);
    some.origins.push_back(blocks.origins[leaf]);
    some.inside.insert(some.inside.end(), word, word + SHERD_LEAF_WORDS);
  }
  some.exteriorBand.resize(some.inside.size());
  some.neighbors = leafNeighborTable(some.origins);
  return some;
}

}  // namespace

Grown growByWeight(GrowthState& state, const SeedTable& seeds, const Steps& steps,
                   const Progress* progress) {
  Levels levels(state);
  levels.seed(seeds, std::vector<cl_uint>(seeds.label.begin(), seeds.label.end()));
  runByWeight(state, levels, steps, progress);
  return levels.finish(makeBuffer<cl_ushort>(state.device, 1), false);
}

Grown growChain(GrowthState& state, const SeedTable& seeds, const sherd_metric& metric,
                const Progress* progress) {
  // Sources are numbered by label, so that ties between them go to the lower label.
  std::vector<cl_uint> order(seeds.item.size()), source(seeds.item.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](cl_uint a, cl_uint b) { return seeds.label[a] < seeds.label[b]; });
  std::vector<cl_int4> voxel;
  std::vector<cl_ushort> label;
  for (const cl_uint i : order) {
    source[i] = static_cast<cl_uint>(voxel.size());
    const openvdb::Coord at = seedVoxel(state, seeds, i);
    voxel.push_back({{at.x(), at.y(), at.z(), 0}});
    label.push_back(seeds.label[i]);
  }
  Levels levels(state);
  levels.seed(seeds, source);
  const DeviceBuffer voxels = uploadBuffer<cl_int4>(state.device, voxel);
  levels.grow(layerSteps(6, {}), true, kBucketsPerVoxel, metric, voxels, progress);
  return levels.finish(uploadBuffer<cl_ushort>(state.device, label), true);
}

void regrowByWeight(GrowthState& state, const DeviceBuffer& labels, const DeviceBuffer& kept,
                    const Steps& steps, const Progress* progress) {
  const auto keptWords = downloaded<cl_ulong>(state.device, kept, state.words());
  const std::vector<cl_uint> leaves = leavesToRegrow(state.blocks, keptWords);
  const LeafBlocks blocks = insideOf(state.blocks, leaves);
  std::vector<cl_uint> itemOf;  // [items of `part`]
  std::vector<cl_ulong> partKept;
  for (cl_uint fracture = 0; fracture < state.fractures; ++fracture) {
    for (const cl_uint leaf : leaves) {
      itemOf.push_back(fracture * state.leafCount + leaf);
      const auto word = keptWords.begin() + std::ptrdiff_t{itemOf.back()} * SHERD_LEAF_WORDS;
      partKept.insert(partKept.end(), word, word + SHERD_LEAF_WORDS);
    }
  }

  GrowthState part(blocks, state.fractures, state.device, state.workGroupSize());
  const DeviceBuffer items = uploadBuffer<cl_uint>(state.device, itemOf);
  const DeviceBuffer partLabels = makeBuffer<cl_ushort>(state.device, part.voxels());
  const DeviceBuffer keptOfPart = uploadBuffer<cl_ulong>(state.device, partKept);
  part.run("gather_voxels", part.items, labels, items, part.items, partLabels);
  Levels levels(part);
  levels.load(partLabels, keptOfPart);
  runByWeight(part, levels, steps, progress);
  levels.save(partLabels, keptOfPart);
  part.run("scatter_voxels", part.items, partLabels, items, part.items, labels);
}

}  // namespace sherd
