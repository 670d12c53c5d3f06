// Growth in stages: grow, roughen, keep connected voxels, regrow the others, extend labels.
#include <sherd/error.h>
#include <sherd/growth.h>
#include <sherd/labels.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "base/finite.h"
#include "base/text/formatted.h"
#include "grow/fields/apart_leaves.h"
#include "grow/fields/check_labels.h"
#include "grow/fields/components.h"
#include "grow/fields/flood.h"
#include "grow/fields/label_slices.h"
#include "grow/fields/relief.h"
#include "grow/fields/rough.h"
#include "grow/fields/seed_kernel.h"
#include "grow/fields/settle.h"
#include "grow/fields/solid_components.h"
#include "grow/splits/sequential.h"
#include "grow/splits/split.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// Returns the largest component, without its sign.
double largestOf(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// Returns the axis nearest to a direction, of equally near ones the first.
std::int32_t nearestAxis(const glm::dvec3& direction) {
  const double most = largestOf(direction);
  return std::abs(direction.x) == most ? 0 : std::abs(direction.y) == most ? 1 : 2;
}

bool isDirection(const glm::dvec3& v) { return isFinite(v) && largestOf(v) > 0.0; }

void check(const GrowOptions& options) {
  const auto need = [](bool good, const char* sentence) {
    if (!good) throw Error(ErrorCode::usage, sentence);
  };
  need(options.neighborhood == 6 || options.neighborhood == 26, "the neighborhood must be 6 or 26");
  need(options.hurst >= 0.1 && options.hurst <= 1.0, "the Hurst exponent must lie in 0.1..1");
  need(options.propagationHurst == 0.0 ||
           (options.propagationHurst >= 0.1 && options.propagationHurst <= 1.0),
       "the Hurst exponent along propagation must be 0 or lie in 0.1..1");
  need(options.propagationHurst == 0.0 || isDirection(options.propagation),
       "the direction of propagation must be finite and not 0");
  for (const Length& length : {options.roughness, options.roughnessWindow}) {
    need(length.voxels >= 0.0 && length.percent >= 0.0 && std::isfinite(length.over(1.0)),
         "the roughness and its window must be 0 or more voxels");
  }
  need(options.longestSideVoxels == 0.0 ||
           (options.longestSideVoxels >= 1.0 && std::isfinite(options.longestSideVoxels)),
       "the longest side must be 0, or 1 or more voxels");
  need(options.outerSteps >= 0 && options.outerSteps <= 64, "the outer steps must lie in 0..64");
  const SplitOptions& split = options.split;
  need(split.power >= 0.0 && split.power <= 10.0, "the power of splits must lie in 0..10");
  need(split.offset >= 0.0 && split.offset <= 0.5, "the offset of splits must lie in 0..0.5");
  need(split.tilt >= 0.0 && split.tilt <= 90.0, "the tilt of splits must lie in 0..90 degrees");
}

// Returns the relief of rough cracks.
Relief reliefOf(const GrowOptions& options, const LeafBlocks& blocks) {
  constexpr double kMost = 100.0;
  const double side = longestSideOr(options.longestSideVoxels, blocks);
  const double height = options.roughness.over(side);
  if (height > kMost) {
    throw Error(
        ErrorCode::usage,
        "the roughness is " + formatted("%.4g", height) + " voxels; at most 100 are possible",
        OptionNames{"roughness"});
  }
  const Length& window = options.roughnessWindow;
  return {.height = height,
          .hurst = options.hurst,
          .window = window.isZero() ? side / 10.0 : window.over(side),
          .longestSide = side,
          .propagationHurst = options.propagationHurst,
          .propagation = nearestAxis(options.propagation)};
}

Metric metricOf(const GrowOptions& options) {
  return ruleOf(options.growth).usesMetric ? options.metric : Metric::euclidean;
}

// The leaves that growth runs over: those of a solid, or, of several layers, those taken apart.
class GrowthLeaves {
 public:
  explicit GrowthLeaves(const LeafBlocks& blocks) : solid_(blocks) {
    if (!blocks.layers.empty()) apart_ = apartLeaves(blocks);
  }

  [[nodiscard]] const ApartLeaves* apart() const { return apart_ ? &*apart_ : nullptr; }
  [[nodiscard]] const LeafBlocks& blocks() const { return apart_ ? *apart_->blocks : solid_; }

  // Layers have the exterior band in common: labels are extended into it afterwards.
  [[nodiscard]] GrowOptions within(GrowOptions options) const {
    if (apart_) options.outerSteps = 0;
    return options;
  }

 private:
  const LeafBlocks& solid_;
  std::optional<ApartLeaves> apart_{};
};

// State of the growth of one batch of fractures.
struct GrowthBatch {
  GrowthState& state;
  const SeedTable& seeds;
  const GrowOptions& options;
  const LeafBlocks& solidBlocks;  // of all layers
  const Progress* progress;
  std::span<const std::shared_ptr<const WallMiddles>> walls{};  // [fractures], of seeds' kernels
  DeviceLabels labels{};
  DeviceBuffer cost{};
  std::vector<std::vector<std::uint64_t>> disconnected{};  // [fracture][pass]

  std::uint32_t perReadback() const {
    return static_cast<std::uint32_t>(
        options.tuning.stepsPerReadback > 0 ? options.tuning.stepsPerReadback : 16);
  }

  // Unweighted layers use the mask kernels of flood.cl.
  bool isUnweightedFlood() const {
    return options.growth == Growth::flood && options.anisotropy.strength == 0.0;
  }

  void store(Grown grown) {
    labels = grown.labels;
    cost = grown.cost;
  }

  const GrowthRule& rule() const { return ruleOf(options.growth); }
  sherd_metric metric() const { return metricFor(metricOf(options), options.anisotropy); }

  void growFirst() {
    if (rule().kernel != nullptr) {
      return store(growByKernel(state, seeds, rule().kernel, metric(), walls, options.keepCost));
    }
    if (options.growth == Growth::chain) return store(growChain(state, seeds, metric(), progress));
    store(
        growByWeight(state, seeds, layerSteps(options.neighborhood, options.anisotropy), progress));
  }

  void roughen() {
    std::vector<std::uint64_t> noise = options.noiseSeeds;
    noise.resize(state.fractures);
    labels = labelsPerVoxel(state, roughened(state, labels, seeds, noise, options.noiseAnchors,
                                             noiseOctaves(reliefOf(options, solidBlocks))));
  }

  // Records the number of voxels that `kept` leaves out.
  KeptComponents recorded(KeptComponents kept) {
    disconnected.resize(state.fractures);
    for (std::size_t f = 0; f < disconnected.size(); ++f)
      disconnected[f].push_back(kept.disconnected[f]);
    return kept;
  }

  // Returns whether a fragment may have several components.
  bool mayBeDisconnected() const {
    const bool severalSeeds =
        std::find(seeds.primary.begin(), seeds.primary.end(), false) != seeds.primary.end();
    const bool byFaces =
        rule().growsOverFaces && (!rule().usesNeighborhood || options.neighborhood == 6);
    return severalSeeds || !byFaces;
  }
};

DeviceBuffer band(GrowthState& state) {
  return uploadBuffer<std::uint64_t>(state.device, state.blocks.exteriorBand);
}

// Sets costs outside to 0: kernels leave those of skipped leaves unset, and write some in the
// exterior band.
void clearOutside(const LeafBlocks& blocks, std::vector<std::uint32_t>& cost) {
  for (std::size_t voxelIndex = 0; voxelIndex < cost.size(); ++voxelIndex) {
    if (!blocks.isInside(voxelIndex)) cost[voxelIndex] = 0;
  }
}

// Returns the labels of the solid's blocks.
std::vector<Labels> readLabels(const GrowthBatch& batch, Flood& last) {
  std::vector<Labels> all(batch.state.fractures);
  const std::uint32_t leaves = batch.state.leafCount;
  const std::size_t voxels = std::size_t{leaves} * SHERD_LEAF_SIZE;
  for (std::uint32_t f = 0; f < all.size(); ++f) {
    all[f].fragment = last.read(f * leaves, leaves);
    if (batch.options.keepCost) {
      all[f].cost = downloaded<std::uint32_t>(batch.state.device, batch.cost, voxels, f * voxels);
      clearOutside(batch.state.blocks, all[f].cost);
    }
    if (!batch.disconnected.empty()) all[f].disconnected = batch.disconnected[f];
    if (const ApartLeaves* const apart = batch.state.apart; apart != nullptr) {
      const std::size_t leavesOfSolid = batch.solidBlocks.count();
      all[f].fragment =
          apart->joined(std::span<const std::uint16_t>(all[f].fragment), leavesOfSolid);
      if (batch.options.keepCost) {
        all[f].cost = apart->joined(std::span<const std::uint32_t>(all[f].cost), leavesOfSolid);
      }
    }
  }
  return all;
}

// Returns the mask of all inside voxels, once per fracture.
DeviceBuffer allInside(GrowthState& state) {
  DeviceBuffer mask = makeBuffer<std::uint64_t>(state.device, state.words());
  const std::size_t bytes = state.blocks.inside.size() * sizeof(std::uint64_t);
  for (std::size_t f = 0; f < state.fractures; ++f) {
    state.device.copy(*state.inside, *mask, f * bytes, bytes);
  }
  return mask;
}

// Returns the voxels connected to their fragments' first seeds.  Where the rule has it so, first
// regrows the others once by the chamfer.
DeviceBuffer connectedToSeeds(GrowthBatch& batch) {
  GrowthState& state = batch.state;
  KeptComponents components =
      batch.recorded(keepSeededComponents(state, batch.labels, batch.seeds));
  if (!batch.rule().regrowsByChamfer) return components.mask;
  if (components.all() && !batch.options.tuning.warmUp) return components.mask;
  regrowByWeight(state, batch.labels, components.mask, chamferSteps(batch.options.anisotropy),
                 batch.progress);
  if (components.all()) return components.mask;
  return batch.recorded(keepSeededComponents(state, batch.labels, batch.seeds)).mask;
}

// Regrows the voxels outside `kept` from their neighbors, then extends labels `outerSteps` into the
// exterior band.
Flood regrown(GrowthBatch& batch, const DeviceBuffer& kept, std::uint32_t outerSteps) {
  GrowthState& state = batch.state;
  Flood flood(state, false);
  flood.load(batch.labels, kept);
  if (batch.options.regrowIsolated) {
    flood.grow(state.inside, SHERD_NO_STEP, batch.perReadback(), batch.progress);
  }
  if (outerSteps > 0) {
    flood.grow(band(state), outerSteps, batch.perReadback(), batch.progress);
  }
  return flood;
}

// Roughens cracks, if they are meant to be, and extends labels into the exterior band.
//   kept  voxels that are connected to their fragment; where cracks are rough all are labeled
Flood roughAndExtended(GrowthBatch& batch, DeviceBuffer kept) {
  if (!batch.options.roughness.isZero()) {
    // A fragment lies in one component of the solid and stays in it when displaced.  It may lose
    // its seed's voxel, so from here its largest component is kept.
    batch.roughen();
    kept = batch.options.regrowIsolated
               ? batch.recorded(keepLargestComponents(batch.state, batch.labels)).mask
               : allInside(batch.state);
  }
  return regrown(batch, kept, static_cast<std::uint32_t>(batch.options.outerSteps));
}

// Runs all stages; the returned flood holds the labels.
Flood growAll(GrowthBatch& batch) {
  GrowthState& state = batch.state;
  const GrowOptions& options = batch.options;
  const auto outer = static_cast<std::uint32_t>(options.outerSteps);
  const bool regrows = options.regrowIsolated && batch.mayBeDisconnected();
  const bool rough = !options.roughness.isZero();

  if (batch.isUnweightedFlood()) {
    Flood flood(state, options.keepCost, options.neighborhood);
    flood.seed(batch.seeds);
    flood.grow(state.inside, SHERD_NO_STEP, batch.perReadback(), batch.progress);
    const bool last = !regrows && !rough && options.neighborhood == 6;  // the band needs 6
    if (last && outer > 0) flood.grow(band(state), outer, batch.perReadback(), batch.progress);
    batch.cost = flood.cost();
    if (last) return flood;
    batch.labels = flood.labels();
  } else {
    batch.growFirst();
  }
  const DeviceBuffer kept = regrows ? connectedToSeeds(batch) : allInside(state);
  if (rough && regrows) batch.labels = regrown(batch, kept, 0).labels();
  return roughAndExtended(batch, kept);
}

// Returns how many fractures grow together: no buffer may exceed the device's largest allocation
// (the cost takes four bytes per voxel), nor all buffers its memory.
//   inWalls  with the ways to the middle of walls, once for all
std::size_t fracturesAtOnce(const LeafBlocks& blocks, const Device& device, bool inWalls) {
  constexpr std::size_t kLargestPerLeaf = sizeof(std::uint32_t) * SHERD_LEAF_SIZE;
  constexpr std::size_t kAllPerLeaf = 8 << 10;  // of chain, the largest: docs/kernels.md, "Memory"
  constexpr std::size_t kWaysPerLeaf = 3 * sizeof(std::int16_t) * SHERD_LEAF_SIZE;
  const DeviceInfo& info = device.info();
  const std::size_t ways = inWalls ? kWaysPerLeaf * blocks.count() : 0;
  const std::size_t leaves =
      std::min(info.largestBufferBytes / kLargestPerLeaf,
               (info.memoryBytes - std::min(ways, info.memoryBytes)) / kAllPerLeaf);
  return std::max<std::size_t>(leaves / std::max<std::size_t>(blocks.count(), 1), 1);
}

// Splits pieces of the state's blocks.
//   components, runs  of the solid
SplitGrowth grownBySplits(GrowthState& state, const VoxelComponents& components,
                          std::span<const SplitRun> runs, const GrowOptions& options,
                          const Progress* progress) {
  if (state.apart == nullptr) return splitPieces(state, components, runs, options, progress);
  const ApartLeaves& apart = *state.apart;
  std::vector<std::vector<glm::dmat3>> walls;
  std::vector<std::vector<double>> densities;
  std::vector<SplitRun> own(runs.begin(), runs.end());
  GuideSides guides;
  if (runs.front().guides != nullptr) guides = *runs.front().guides;
  for (std::vector<std::uint64_t>& positive : guides.positive) {
    positive = apart.gathered(std::span<const std::uint64_t>(positive), 8);
  }
  for (SplitRun& run : own) {
    walls.push_back(run.walls.empty() ? std::vector<glm::dmat3>() : apart.gathered(run.walls));
    densities.push_back(run.densities.empty() ? std::vector<double>()
                                              : apart.gathered(run.densities));
    run.walls = walls.back();
    run.densities = densities.back();
    if (run.guides != nullptr) run.guides = &guides;
  }
  return splitPieces(state, apartComponents(components, apart), own, options, progress);
}

std::vector<SeededLabels> splitBatch(const std::shared_ptr<const LeafBlocks>& blocks,
                                     const VoxelComponents& components,
                                     std::span<const SplitRun> runs, Device& device,
                                     const GrowOptions& options, const Progress* progress) {
  const GrowthLeaves leaves(*blocks);
  const GrowOptions own = leaves.within(options);
  GrowthState state(leaves.blocks(), runs.size(), implOf(device), options.tuning.workGroupSize,
                    leaves.apart());
  SplitGrowth grown = grownBySplits(state, components, runs, own, progress);
  std::vector<std::vector<Seed>> seedSets;
  for (const SplitPieces& each : grown.fractures) seedSets.push_back(each.seeds);
  const SeedTable table = tableOf(state.blocks, seedSets, state.firstOfLayer());
  GrowthBatch batch{state, table, own, *blocks, progress};
  batch.labels = grown.labels;
  Flood last = roughAndExtended(batch, allInside(state));
  std::vector<Labels> labels = readLabels(batch, last);
  std::vector<SeededLabels> all;
  for (std::size_t f = 0; f < labels.size(); ++f) {
    labels[f].blocks = blocks;
    labels[f].fragmentCount = static_cast<int>(seedSets[f].size());
    if (leaves.apart() != nullptr) {
      labels[f] = extendLabels(std::move(labels[f]), device, options.outerSteps);
    }
    labels[f].splits = std::move(grown.fractures[f].splits);
    std::vector<std::size_t> guided;
    for (const Split& split : labels[f].splits) {
      if (split.isSphere || split.normal != glm::ivec3(0)) continue;
      guided.push_back(static_cast<std::size_t>(split.offset));
    }
    if (!options.roughness.isZero()) {
      for (Split& split : labels[f].splits) {
        split.normal = glm::ivec3(0);
        split.isSphere = false;
      }
    } else {
      if (runs.front().guides != nullptr) labels[f].cracks = runs.front().guides->cracks;
      labels[f].walls = runs[f].middles;
    }
    all.push_back({std::move(seedSets[f]), std::move(labels[f]), 0.0,
                   std::move(grown.fractures[f].shares), std::move(guided)});
  }
  return all;
}

std::vector<Labels> growBatch(const std::shared_ptr<const LeafBlocks>& blocks,
                              std::span<const std::vector<Seed>> seedSets, Device& device,
                              const GrowOptions& options, const Progress* progress) {
  std::vector<std::vector<Seed>> settledSets(seedSets.begin(), seedSets.end());
  std::vector<std::shared_ptr<const WallMiddles>> walls;
  if (givesCells(options)) walls = options.walls;
  walls.resize(seedSets.size());
  if (ruleOf(options.growth).kernel != nullptr) {
    for (std::size_t f = 0; f < settledSets.size(); ++f) {
      settledSets[f] = settled(settledSets[f], metricOf(options), options.anisotropy, walls[f]);
    }
  }
  const GrowthLeaves leaves(*blocks);
  const GrowOptions own = leaves.within(options);
  GrowthState state(leaves.blocks(), seedSets.size(), implOf(device), options.tuning.workGroupSize,
                    leaves.apart());
  const SeedTable table = tableOf(state.blocks, settledSets, state.firstOfLayer());
  GrowthBatch batch{state, table, own, *blocks, progress, walls};
  Flood last = growAll(batch);
  std::vector<Labels> all = readLabels(batch, last);
  for (std::size_t f = 0; f < all.size(); ++f) {
    all[f].blocks = blocks;
    all[f].fragmentCount = fragmentsOf(seedSets[f]);
    if (leaves.apart() != nullptr) {
      all[f] = extendLabels(std::move(all[f]), device, options.outerSteps);
    }
    if (!givesCells(options) || !options.roughness.isZero()) continue;
    all[f].sites = {std::move(settledSets[f]), options.anisotropy};
    all[f].walls = walls[f];
  }
  return all;
}

// Grows fractures in batches that fit the device.
//   inWalls  as of fracturesAtOnce
template <class Grown, class Run, class Grow>
std::vector<Grown> inBatches(std::span<const Run> runs, const LeafBlocks& blocks,
                             const Device& device, bool inWalls, const GrowOptions& options,
                             const Grow& grow) {
  const std::size_t batch = fracturesAtOnce(blocks, device, inWalls);
  std::vector<Grown> all;
  for (std::size_t first = 0; first < runs.size(); first += batch) {
    const std::size_t count = std::min(batch, runs.size() - first);
    GrowOptions batchOptions = options;
    const auto from = [&](auto& perRun) {
      perRun.resize(runs.size());
      perRun.erase(perRun.begin(), perRun.begin() + static_cast<std::ptrdiff_t>(first));
    };
    from(batchOptions.noiseSeeds);
    from(batchOptions.noiseAnchors);
    from(batchOptions.walls);
    for (Grown& grown : grow(runs.subspan(first, count), batchOptions)) {
      all.push_back(std::move(grown));
    }
  }
  return all;
}

}  // namespace

std::vector<Labels> grow(std::shared_ptr<const LeafBlocks> blocks,
                         std::span<const std::vector<Seed>> seedSets, Device& device,
                         const GrowOptions& options, const Progress* progress) {
  check(options);
  if (!blocks) throw Error(ErrorCode::usage, "there are no leaf blocks to grow over");
  if (ruleOf(options.growth).splits) {
    throw Error(ErrorCode::usage, "this growth splits a solid, and does not grow from seeds",
                OptionNames{"growth"});
  }
  bool inWalls = false;
  for (const std::shared_ptr<const WallMiddles>& walls : options.walls) {
    if (walls == nullptr) continue;
    inWalls = true;
    if (walls->blocks().origins == blocks->origins) continue;
    throw Error(ErrorCode::usage, "the walls are those of other leaf blocks");
  }
  const auto growSome = [&](auto sets, const auto& own) {
    return growBatch(blocks, sets, device, own, progress);
  };
  return inBatches<Labels>(seedSets, *blocks, device, inWalls, options, growSome);
}

std::vector<SeededLabels> growBySplits(std::shared_ptr<const LeafBlocks> blocks,
                                       const VoxelComponents& components,
                                       std::span<const SplitRun> runs, Device& device,
                                       const GrowOptions& options, const Progress* progress) {
  check(options);
  const std::uint64_t voxels = blocks->insideVoxels();
  for (const SplitRun& run : runs) {
    if (run.shares.size() <= voxels) continue;
    throw Error(ErrorCode::usage,
                std::to_string(run.shares.size()) + " pieces do not fit into a solid of " +
                    std::to_string(voxels) + " voxels; try a higher resolution",
                OptionNames{"resolution"});
  }
  const bool inWalls = std::any_of(runs.begin(), runs.end(),
                                   [](const SplitRun& run) { return run.middles != nullptr; });
  const auto growSome = [&](auto some, const auto& own) {
    return splitBatch(blocks, components, some, device, own, progress);
  };
  return inBatches<SeededLabels>(runs, *blocks, device, inWalls, options, growSome);
}

std::vector<GivenSplits> decideSplits(const LeafBlocks& blocks, const VoxelComponents& components,
                                      std::span<const SplitRun> runs, Device& device,
                                      const GrowOptions& options, const Progress* progress) {
  check(options);
  const auto decideSome = [&](auto some, const auto& own) {
    const GrowthLeaves leaves(blocks);
    GrowthState state(leaves.blocks(), some.size(), implOf(device), own.tuning.workGroupSize,
                      leaves.apart());
    std::vector<GivenSplits> all;
    SplitGrowth grown = grownBySplits(state, components, some, leaves.within(own), progress);
    for (SplitPieces& each : grown.fractures) all.push_back(std::move(each.decided));
    return all;
  };
  return inBatches<GivenSplits>(runs, blocks, device, true, options, decideSome);
}

Labels extendLabels(Labels labels, Device& device, int steps) {
  checkLabels(labels);
  GrowthState state(*labels.blocks, 1, implOf(device));
  Flood flood(state, false);
  flood.load(labelsPerVoxel(state, uploadBuffer<std::uint16_t>(state.device, labels.fragment)),
             state.inside);
  flood.grow(band(state), static_cast<std::uint32_t>(steps), 16, nullptr);
  labels.fragment = flood.read(0, state.leafCount);
  return labels;
}

std::vector<std::uint64_t> countVoxels(const Labels& labels) {
  checkLabels(labels);
  std::vector<std::uint64_t> counts(std::size_t{Labels::kEroded} + 1);
  for (std::size_t leaf = 0; leaf < labels.blocks->count(); ++leaf) {
    forEachLabelSlice(labels, leaf, [&](std::uint16_t label, std::size_t, std::uint64_t bits) {
      counts[label] += static_cast<std::size_t>(std::popcount(bits));
    });
  }
  const auto end = static_cast<std::size_t>(labels.fragmentCount) + 1;
  for (std::size_t label = end; label < Labels::kEroded; ++label) {
    if (counts[label] == 0) continue;
    throw Error(ErrorCode::usage, "a voxel has label " + std::to_string(label) + "; there are " +
                                      std::to_string(labels.fragmentCount) + " fragments");
  }
  counts.resize(end);
  return counts;
}

}  // namespace sherd
