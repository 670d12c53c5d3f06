// Growth, stage by stage: grow, roughen, keep what hangs together, regrow the rest, carry outwards.
#include <sherd/error.h>
#include <sherd/labels.h>

#include <algorithm>
#include <cmath>

#include "grow/components.h"
#include "grow/flood.h"
#include "grow/nearest.h"
#include "grow/relief.h"
#include "grow/rough.h"

namespace sherd {
namespace {

void check(const GrowOptions& options) {
  const auto need = [](bool good, const char* sentence) {
    if (!good) throw Error(ErrorCode::usage, sentence);
  };
  need(options.neighborhood == 6 || options.neighborhood == 26, "a neighborhood is 6 or 26");
  need(options.roughness >= 0.0 && options.roughness <= 100.0, "the roughness lies in 0..100");
  need(options.hurst >= 0.1 && options.hurst <= 1.0, "the Hurst exponent lies in 0.1..1");
  need(options.roughnessWindow >= 0.0 && std::isfinite(options.roughnessWindow),
       "the window of the roughness is 0 or more voxels");
  need(options.outerSteps >= 0 && options.outerSteps <= 64, "the outer steps lie in 0..64");
}

// A tenth of the longest side of the solid.
double tenthOfSide(const LeafBlocks& blocks) {
  const openvdb::Coord dims = insideBox(blocks).dims();
  return std::max({dims.x(), dims.y(), dims.z()}) / 10.0;
}

// The growth of a batch, on its way.
struct Growing {
  GrowthState& state;
  const SeedTable& seeds;
  const GrowOptions& options;
  const Progress* progress;
  DeviceBuffer labels{}, cost{};
  std::vector<std::vector<std::uint64_t>> freed{};  // [fracture][time]

  std::uint32_t perReadback() const {
    return static_cast<std::uint32_t>(options.stepsPerReadback > 0 ? options.stepsPerReadback : 16);
  }

  // Plain layers go by masks.
  bool isPlainFlood() const {
    return options.growth == Growth::flood && options.grain.strength == 0.0;
  }

  void take(Grown grown) {
    labels = grown.labels;
    cost = grown.cost;
  }

  void growFirst() {
    switch (options.growth) {
      case Growth::flood:
        return take(
            growByWeight(state, seeds, layerSteps(options.neighborhood, options.grain), progress));
      case Growth::chain:
        return take(growChain(state, seeds, metricFor(options.metric, options.grain), progress));
      case Growth::nearest:
        return take(
            growNearest(state, seeds, metricFor(options.metric, options.grain), options.keepCost));
      case Growth::euclid:
        return take(growNearest(state, seeds, metricFor(Metric::euclidean, options.grain),
                                options.keepCost));
    }
  }

  void roughen() {
    std::vector<std::uint64_t> noise = options.noiseSeeds;
    noise.resize(state.fractures);
    const double window =
        options.roughnessWindow > 0 ? options.roughnessWindow : tenthOfSide(state.blocks);
    labels = roughened(state, labels, seeds, noise,
                       octaveAmplitudes(options.roughness, options.hurst, window));
  }

  // Count what `kept` leaves out.
  KeptParts noted(KeptParts kept) {
    freed.resize(state.fractures);
    for (std::size_t f = 0; f < freed.size(); ++f) freed[f].push_back(kept.freed[f]);
    return kept;
  }

  // Can a fragment have fallen into several parts?
  bool mayBeCutOff() const {
    const bool severalSeeds =
        std::find(seeds.primary.begin(), seeds.primary.end(), false) != seeds.primary.end();
    const bool byFaces = options.growth == Growth::chain ||
                         (options.growth == Growth::flood && options.neighborhood == 6);
    return severalSeeds || !byFaces;
  }
};

DeviceBuffer band(GrowthState& state) {
  return uploadBuffer<std::uint64_t>(state.device, state.blocks.outerBand);
}

// Kernels leave costs of leaves that they skip as they were, and layers in the outer band their
// own.
void clearOutside(const LeafBlocks& blocks, std::vector<std::uint32_t>& cost) {
  for (std::size_t place = 0; place < cost.size(); ++place) {
    if (!blocks.isInside(place)) cost[place] = 0;
  }
}

std::vector<Labels> read(const Growing& growing, Flood& last) {
  std::vector<Labels> all(growing.state.fractures);
  const cl_uint leaves = growing.state.leafCount;
  const std::size_t voxels = std::size_t{leaves} * SHERD_LEAF_SIZE;
  for (cl_uint f = 0; f < all.size(); ++f) {
    all[f].fragment = last.read(f * leaves, leaves);
    if (growing.options.keepCost) {
      all[f].cost =
          downloaded<std::uint32_t>(growing.state.device, growing.cost, voxels, f * voxels);
      clearOutside(growing.state.blocks, all[f].cost);
    }
    if (!growing.freed.empty()) all[f].freed = growing.freed[f];
  }
  return all;
}

// Every inside voxel, as a mask for each fracture.
DeviceBuffer allInside(GrowthState& state) {
  DeviceBuffer mask = makeBuffer<cl_ulong>(state.device, state.words());
  const std::size_t bytes = state.blocks.inside.size() * sizeof(cl_ulong);
  for (std::size_t f = 0; f < state.fractures; ++f) {
    state.device.queue.enqueueCopyBuffer(state.inside, mask, 0, f * bytes, bytes);
  }
  return mask;
}

// The parts that hold their fragments' first seeds; euclid regrows the rest by its chamfer once.
DeviceBuffer settled(Growing& growing) {
  GrowthState& state = growing.state;
  KeptParts parts = growing.noted(keepSeededParts(state, growing.labels, growing.seeds));
  if (growing.options.growth != Growth::euclid) return parts.mask;
  if (parts.all() && !growing.options.rehearse) return parts.mask;
  regrowByWeight(state, growing.labels, parts.mask, chamferSteps(growing.options.grain),
                 growing.progress);
  if (parts.all()) return parts.mask;
  return growing.noted(keepSeededParts(state, growing.labels, growing.seeds)).mask;
}

// Give the rest of the inside to the neighbours of what is kept, then carry labels outwards.
Flood regrown(Growing& growing, const DeviceBuffer& kept, std::uint32_t outerSteps) {
  GrowthState& state = growing.state;
  Flood flood(state, false);
  flood.load(growing.labels, kept);
  if (growing.options.regrowIsolated) {
    flood.grow(state.inside, SHERD_NO_STEP, growing.perReadback(), growing.progress);
  }
  if (outerSteps > 0) {
    flood.grow(band(state), outerSteps, growing.perReadback(), growing.progress);
  }
  return flood;
}

// The growth that all ways end with has the labels.
Flood growAll(Growing& growing) {
  GrowthState& state = growing.state;
  const GrowOptions& options = growing.options;
  const auto outer = static_cast<std::uint32_t>(options.outerSteps);
  const bool settles = options.regrowIsolated && growing.mayBeCutOff();
  const bool rough = options.roughness > 0.0;

  if (growing.isPlainFlood()) {
    Flood flood(state, options.keepCost, options.neighborhood);
    flood.seed(growing.seeds);
    flood.grow(state.inside, SHERD_NO_STEP, growing.perReadback(), growing.progress);
    const bool last = !settles && !rough && options.neighborhood == 6;  // the band is over faces
    if (last && outer > 0) flood.grow(band(state), outer, growing.perReadback(), growing.progress);
    growing.cost = flood.cost();
    if (last) return flood;
    growing.labels = flood.labels();
  } else {
    growing.growFirst();
  }
  DeviceBuffer kept = settles ? settled(growing) : allInside(state);
  if (rough) {
    // A fragment is in one part of the solid before it is displaced, and stays there; it may be
    // carried off its seed, so now its largest part counts.
    if (settles) growing.labels = regrown(growing, kept, 0).labels();
    growing.roughen();
    kept = options.regrowIsolated ? growing.noted(keepLargestParts(state, growing.labels)).mask
                                  : allInside(state);
  }
  return regrown(growing, kept, outer);
}

bool givesVoronoiCells(const GrowOptions& options) {
  return options.roughness == 0.0 &&
         (options.growth == Growth::euclid ||
          (options.growth == Growth::nearest && options.metric == Metric::euclidean));
}

// How many grow together: no buffer may pass the device's largest allocation, where those of the
// cost hold four bytes a voxel, nor all buffers its memory.
std::size_t fracturesAtOnce(const LeafBlocks& blocks, const Device& device) {
  constexpr std::size_t kLargestPerLeaf = sizeof(cl_uint) * SHERD_LEAF_SIZE;
  constexpr std::size_t kAllPerLeaf = 8 << 10;  // chain's, the most: docs/kernels.md, "Memory"
  const DeviceInfo& info = device.info();
  const std::size_t leaves =
      std::min(info.largestBufferBytes / kLargestPerLeaf, info.memoryBytes / kAllPerLeaf);
  return std::max<std::size_t>(leaves / std::max<std::size_t>(blocks.count(), 1), 1);
}

std::vector<Labels> growBatch(const LeafBlocks& blocks, std::span<const std::vector<Seed>> seedSets,
                              Device& device, const GrowOptions& options,
                              const Progress* progress) {
  const SeedTable table = tableOf(blocks, seedSets);
  return withDevice(device.impl(), "growing fragments", [&] {
    GrowthState state(blocks, seedSets.size(), device.impl(), options.workGroupSize);
    Growing growing{state, table, options, progress};
    Flood last = growAll(growing);
    std::vector<Labels> all = read(growing, last);
    if (givesVoronoiCells(options)) {
      for (std::size_t f = 0; f < all.size(); ++f) {
        all[f].sites = {{seedSets[f].begin(), seedSets[f].end()}, options.grain};
      }
    }
    return all;
  });
}

}  // namespace

std::vector<Labels> grow(const LeafBlocks& blocks, std::span<const std::vector<Seed>> seedSets,
                         Device& device, const GrowOptions& options, const Progress* progress) {
  check(options);
  const std::size_t most = fracturesAtOnce(blocks, device);
  std::vector<Labels> all;
  for (std::size_t first = 0; first < seedSets.size(); first += most) {
    const std::size_t count = std::min(most, seedSets.size() - first);
    GrowOptions own = options;
    own.noiseSeeds.resize(seedSets.size());
    own.noiseSeeds.erase(own.noiseSeeds.begin(),
                         own.noiseSeeds.begin() + static_cast<std::ptrdiff_t>(first));
    for (Labels& labels :
         growBatch(blocks, seedSets.subspan(first, count), device, own, progress)) {
      all.push_back(std::move(labels));
    }
  }
  return all;
}

Labels carriedOverBand(const LeafBlocks& blocks, Labels labels, Device& device, int steps) {
  return withDevice(device.impl(), "carrying labels outwards", [&] {
    GrowthState state(blocks, 1, device.impl());
    Flood flood(state, false);
    flood.load(uploadBuffer<std::uint16_t>(state.device, labels.fragment), state.inside);
    flood.grow(band(state), static_cast<std::uint32_t>(steps), 16, nullptr);
    labels.fragment = flood.read(0, state.leafCount);
    return std::move(labels);
  });
}

std::vector<std::uint64_t> countVoxels(const LeafBlocks& blocks, const Labels& labels,
                                       int fragments) {
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(fragments) + 1);
  blocks.forEachInside([&](std::size_t place) {
    const std::uint16_t label = labels.fragment[place];
    if (label != Labels::kWorn) ++counts[label];
  });
  return counts;
}

}  // namespace sherd
