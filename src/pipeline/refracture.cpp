// Refracture: each broken fragment is a separate solid for seeds and growth; the cut is then
// recomputed for all fragments together.
#include <sherd/error.h>
#include <sherd/fracture.h>

#include <optional>
#include <set>

#include "base/random.h"
#include "grow/small_components.h"
#include "pipeline/fracture_stages.h"
#include "pipeline/guide_surfaces.h"
#include "pipeline/refracture_islands.h"
#include "pipeline/refracture_meshes.h"
#include "voxelize/distance.h"
#include "voxelize/wall_middles.h"

namespace sherd {
namespace {

// Returns a fragment as a solid over the same leaves.
//   hasBand  with an exterior band, which exact surfaces need
Solid solidOf(const FinishedFracture& finished, int id, bool hasBand) {
  LeafBlocks blocks = blocksOf(finished, id);
  if (hasBand) setExteriorBand(blocks);
  Solid fragment = finished.solid;
  fragment.region = nullptr;  // it holds for the whole
  fragment.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  measureVoxels(fragment);
  return fragment;
}

//   walls  of the whole solid
SeededLabels breakFragment(const Solid& fragment, int id, const FractureOptions& options,
                           SolidWalls& walls, Device& device, const Progress* progress) {
  const std::uint64_t seed =
      randomBits(options.seed, Stage::refracture, static_cast<std::uint64_t>(id));
  const VoxelComponents components = findComponents(*fragment.blocks, device);
  std::vector<Seed> seeds;
  if (!ruleOf(options.grow.growth).splits) {
    seeds = placeSeeds(fragment, components, seedOptionsFor(options, seed), progress);
  }
  FractureOptions own = options;
  if (own.grow.roughnessWindow.isZero()) {  // a tenth of the fragment, not of the whole mesh
    own.grow.roughnessWindow = fragment.box.longestSide() / 10.0;
  }
  // Splits follow the fragment's own surface, old cracks included.
  SolidWalls ownWalls(fragment);
  SolidWalls& followed = ruleOf(options.grow.growth).splits ? ownWalls : walls;
  return growFor(own, fragment, components, std::move(seeds), seed, followed, device, progress);
}

// The splits of all broken fragments: a guide does something if it divides one of them.
struct GuidedSplits {
  std::vector<std::size_t> guide{}, cracks{};  // as SeededLabels::guide and guided
  std::size_t splits = 0;

  void add(const SeededLabels& grown) {
    guide = grown.guide;  // the same of all
    cracks.insert(cracks.end(), grown.guided.begin(), grown.guided.end());
    splits += grown.labels.splits.size();
  }
};

std::set<int> existingIds(std::span<const int> given, int fragments) {
  std::set<int> ids(given.begin(), given.end());
  for (const int id : ids) {
    if (id < 1 || id > fragments) {
      throw Error(ErrorCode::usage, "there is no fragment " + std::to_string(id) +
                                        ", the fracture has 1.." + std::to_string(fragments));
    }
  }
  return ids;
}

// Returns [old fragments + 1] the new ids of fragments that are not broken, else 0, and adds them.
std::vector<std::uint16_t> idsOfKept(int fragments, const std::set<int>& broken,
                                     std::vector<int>& parents) {
  std::vector<std::uint16_t> newId(static_cast<std::size_t>(fragments) + 1, 0);
  for (int id = 1; id <= fragments; ++id) {
    if (broken.count(id)) continue;
    parents.push_back(id);
    newId[static_cast<std::size_t>(id)] = static_cast<std::uint16_t>(parents.size());
  }
  return newId;
}

}  // namespace

GrownFracture regrown(const FinishedFracture& read, std::span<const int> only,
                      const FractureOptions& options, Device& device, const Progress* progress) {
  checkOptions(options);
  const std::set<int> broken = existingIds(only, read.labels.fragmentCount);
  const std::optional<FinishedFracture> connected = withoutIslands(read, broken, device);
  const FinishedFracture& finished = connected ? *connected : read;
  StageClock clock;
  GrownFracture all;
  all.seed = options.seed;
  FractureResult& result = all.result;
  result.solid = finished.solid;
  result.components = findComponents(*finished.solid.blocks, device).count();
  result.labels.blocks = finished.solid.blocks;
  result.labels.fragment.assign(finished.labels.fragment.size(), 0);
  const std::vector<std::uint16_t> newId =
      idsOfKept(finished.labels.fragmentCount, broken, result.parents);
  finished.solid.blocks->forEachInside([&](std::size_t voxelIndex) {
    result.labels.fragment[voxelIndex] = newId[finished.labels.fragment[voxelIndex]];
  });
  const bool isExact = options.surface.surface == Surface::automatic
                           ? read.isExact && surfaceOf(options) == Surface::exact
                           : options.surface.surface == Surface::exact;
  std::vector<BrokenFragment> parts;
  GuidedSplits guided;
  SolidWalls walls(finished.solid);
  for (const int id : broken) {
    Solid fragment = solidOf(finished, id, isExact);
    SeededLabels grown = breakFragment(fragment, id, options, walls, device, progress);
    guided.add(grown);
    const std::size_t first = result.parents.size();
    result.parents.insert(result.parents.end(), static_cast<std::size_t>(fragmentsOf(grown.seeds)),
                          id);
    if (result.parents.size() > kMaxFragments) {
      throw Error(ErrorCode::usage,
                  "there would be more than " + std::to_string(kMaxFragments) + " fragments");
    }
    fragment.blocks->forEachInside([&](std::size_t voxelIndex) {
      result.labels.fragment[voxelIndex] =
          static_cast<std::uint16_t>(first + grown.labels.fragment[voxelIndex]);
    });
    for (Seed seed : grown.seeds) {
      seed.fragment = static_cast<std::uint16_t>(first + seed.fragment);
      result.seeds.push_back(seed);
    }
    if (isExact) parts.push_back({id, first, std::move(fragment), std::move(grown.labels)});
  }
  result.guideWarnings = guideWarnings(options.guides, guided.guide, guided.cracks, guided.splits);
  result.labels.fragmentCount = static_cast<int>(result.parents.size());
  result.labels = extendLabels(std::move(result.labels), device, options.grow.outerSteps);
  result.eroded.assign(result.parents.size() + 1, 0);
  clock.done("grow");
  if (isExact) {
    all.exact = exactMeshesAgain(finished, parts, newId, result.labels, options.surface.adaptivity,
                                 progress);
    clock.done("extract");
  }
  result.times = clock.times();
  return all;
}

FractureResult refracture(const FinishedFracture& finished, std::span<const int> only,
                          const FractureOptions& options, Device& device,
                          const Progress* progress) {
  FractureResult result =
      extracted(regrown(finished, only, options, device, progress), options, progress);
  if (options.surface.meshes) result.surfaces.reset();
  return result;
}

}  // namespace sherd
