// Host side of kernels/levels.cl.
#include "grow/fields/levels.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

constexpr std::uint32_t kPassesPerReadback = 32;
constexpr std::uint32_t kBucketsPerVoxel = 2;  // of chain
constexpr std::size_t kControlWords = 11;

class Levels {
 public:
  explicit Levels(GrowthState& state)
      : state_(state),
        owned_(state.filled<std::uint64_t>(state.words(), 0)),
        offered_(state.filled<std::uint64_t>(state.words(), 0)),
        source_(makeBuffer<std::uint32_t>(state.device, state.voxels())),
        cost_(makeBuffer<std::uint32_t>(state.device, state.voxels())),
        claim_(state.filled<std::uint64_t>(2 * state.words(), 0)),
        claimed_(state.filled<std::uint32_t>(2 * std::size_t{state.items}, 0)),
        wake_(state.filled<std::uint32_t>(state.items, SHERD_NO_STEP)),
        dirty_(state.filled<std::uint32_t>(state.items, 0)),
        queued_(state.filled<std::uint32_t>(state.items, 0)),
        list_(makeBuffer<std::uint32_t>(state.device, 2 * std::size_t{state.items})),
        taken_(makeBuffer<std::uint32_t>(state.device, state.items)) {
    std::array<std::uint32_t, kControlWords> control{};
    for (std::size_t i = 3; i < 6; ++i) control[i] = SHERD_NO_STEP;  // no offer waits
    control_ = uploadBuffer<std::uint32_t>(state.device, control);
  }

  void seed(const SeedTable& table, std::span<const std::uint32_t> source) {
    fillBuffer(state_.device, cost_, state_.voxels(), std::uint32_t{0});
    const SeedGroups seeds = groupsOf(state_, table);
    const DeviceBuffer sources = uploadBuffer<std::uint32_t>(state_.device, source);
    launch("levels_seed", seeds.count, seeds.item, seeds.first, seeds.offset, sources, seeds.count);
    state_.device.finish();  // the seeds' buffers are released here
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
  void grow(const Steps& steps, bool chain, std::uint32_t stride, const sherd_metric& metric,
            const DeviceBuffer& seeds, const Progress* progress) {
    const DeviceBuffer stepBuffer = uploadBuffer<Int4>(state_.device, steps.step);
    const DeviceBuffer within = uploadBuffer<std::int32_t>(state_.device, steps.within);
    launch("levels_begin", state_.items);
    const auto count = static_cast<std::uint32_t>(steps.step.size());
    const DeviceBuffer& origin = state_.origin();
    for (std::uint32_t pass = 1;;) {
      for (std::uint32_t k = 0; k < kPassesPerReadback; ++k, ++pass) {
        launch("levels_take", state_.items, pass, stepBuffer, within, count,
               static_cast<std::uint32_t>(chain), stride, metric, seeds, origin);
        launch("levels_publish", state_.items, pass, count);
      }
      std::array<std::uint32_t, kControlWords> control;
      readBuffer<std::uint32_t>(state_.device, control_, control);
      reportProgress(progress, "grow", 0.0);
      if (control[pass % 3] == 0) break;
    }
  }

  Grown finish(const DeviceBuffer& labelOfSource, bool chain) {
    const DeviceBuffer labels = makeBuffer<std::uint16_t>(state_.device, state_.voxels());
    launch("levels_finish", state_.items, labelOfSource, static_cast<std::uint32_t>(chain), labels);
    return {labelsPerVoxel(state_, labels), cost_};
  }

 private:
  // Launches a kernel that takes LEVELS_STATE and these arguments.
  template <class... Arguments>
  void launch(const char* name, std::size_t work, const Arguments&... arguments) {
    state_.run(name, work, state_.inside, state_.neighbors27(), state_.leafCount, state_.items,
               owned_, offered_, source_, cost_, claim_, claimed_, wake_, dirty_, queued_, list_,
               taken_, control_, arguments...);
  }

  GrowthState& state_;
  DeviceBuffer owned_, offered_, source_, cost_, claim_, claimed_, wake_, dirty_, queued_, list_,
      taken_, control_;
};

void runByWeight(GrowthState& state, Levels& levels, const Steps& steps, const Progress* progress) {
  const DeviceBuffer none = makeBuffer<Int4>(state.device, 1);
  levels.grow(steps, false, steps.leastWeight, sherd_metric{}, none, progress);
}

// Returns the leaves with an inside voxel outside `kept` in any fracture, and the leaves around
// them: no other voxel makes or takes an offer.
std::vector<std::uint32_t> leavesToRegrow(const GrowthState& state,
                                          std::span<const std::uint64_t> kept) {
  const LeafBlocks& blocks = state.blocks;
  std::vector<bool> regrows(blocks.count()), reached(blocks.count());
  for (std::size_t word = 0; word < kept.size(); ++word) {
    const std::size_t leafWord = word % blocks.inside.size();
    if (blocks.inside[leafWord] & ~kept[word]) regrows[leafWord / SHERD_LEAF_WORDS] = true;
  }
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    if (!regrows[leaf]) continue;
    for (int k = 0; k < 27; ++k) {
      const openvdb::Coord offset(8 * (k / 9 - 1), 8 * (k / 3 % 3 - 1), 8 * (k % 3 - 1));
      const std::uint32_t around = findBeside(blocks, state.firstOfLayer(), leaf, offset);
      if (around != LeafBlocks::kNone) reached[around] = true;
    }
  }
  std::vector<std::uint32_t> leaves;
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    if (reached[leaf]) leaves.push_back(static_cast<std::uint32_t>(leaf));
  }
  return leaves;
}

}  // namespace

Grown growByWeight(GrowthState& state, const SeedTable& seeds, const Steps& steps,
                   const Progress* progress) {
  Levels levels(state);
  levels.seed(seeds, std::vector<std::uint32_t>(seeds.label.begin(), seeds.label.end()));
  runByWeight(state, levels, steps, progress);
  return levels.finish(makeBuffer<std::uint16_t>(state.device, 1), false);
}

Grown growChain(GrowthState& state, const SeedTable& seeds, const sherd_metric& metric,
                const Progress* progress) {
  // Sources are numbered by label, so that ties between them go to the lower label.
  std::vector<std::uint32_t> order(seeds.item.size()), source(seeds.item.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return seeds.label[a] < seeds.label[b];
  });
  std::vector<Int4> voxel;
  std::vector<std::uint16_t> label;
  for (const std::uint32_t i : order) {
    source[i] = static_cast<std::uint32_t>(voxel.size());
    const openvdb::Coord at = seedVoxel(state, seeds, i);
    voxel.push_back({at.x(), at.y(), at.z(), 0});
    label.push_back(seeds.label[i]);
  }
  Levels levels(state);
  levels.seed(seeds, source);
  const DeviceBuffer voxels = uploadBuffer<Int4>(state.device, voxel);
  levels.grow(layerSteps(6, {}), true, kBucketsPerVoxel, metric, voxels, progress);
  return levels.finish(uploadBuffer<std::uint16_t>(state.device, label), true);
}

void regrowByWeight(GrowthState& state, const DeviceLabels& labels, const DeviceBuffer& kept,
                    const Steps& steps, const Progress* progress) {
  const auto keptWords = downloaded<std::uint64_t>(state.device, kept, state.words());
  const std::vector<std::uint32_t> leaves = leavesToRegrow(state, keptWords);
  const ApartLeaves some = insideOf(state.blocks, state.firstOfLayer(), leaves);
  std::vector<std::uint32_t> itemOf;  // [items of `part`]
  std::vector<std::uint64_t> partKept;
  for (std::uint32_t fracture = 0; fracture < state.fractures; ++fracture) {
    for (const std::uint32_t leaf : leaves) {
      itemOf.push_back(fracture * state.leafCount + leaf);
      const auto word = keptWords.begin() + std::ptrdiff_t{itemOf.back()} * SHERD_LEAF_WORDS;
      partKept.insert(partKept.end(), word, word + SHERD_LEAF_WORDS);
    }
  }

  GrowthState part(*some.blocks, state.fractures, state.device, state.workGroupSize(), &some);
  const DeviceBuffer items = uploadBuffer<std::uint32_t>(state.device, itemOf);
  const DeviceBuffer partLabels = makeBuffer<std::uint16_t>(state.device, part.voxels());
  const DeviceBuffer keptOfPart = uploadBuffer<std::uint64_t>(state.device, partKept);
  part.run("expand_labels", part.items, state.inside, state.leafCount, items, part.items,
           labels.owner, labels.tag, labels.second);
  part.run("gather_voxels", part.items, labels.owner, items, part.items, partLabels);
  Levels levels(part);
  levels.load(partLabels, keptOfPart);
  runByWeight(part, levels, steps, progress);
  levels.save(partLabels, keptOfPart);
  part.run("scatter_voxels", part.items, partLabels, items, part.items, labels.owner);
}

}  // namespace sherd
