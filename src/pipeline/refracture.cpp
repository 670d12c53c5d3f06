// Breaking fragments again: each is a solid of its own for seeds and growth; the cut is then made
// anew for all of them together.
#include <sherd/error.h>
#include <sherd/refracture.h>

#include <set>

#include "base/random.h"
#include "grow/specks.h"
#include "pipeline/fracture_stages.h"
#include "voxelize/distance.h"

namespace sherd {
namespace {

// One fragment's voxels as a solid, over the same leaves.
Solid portion(const FinishedFracture& finished, int id) {
  Solid part = finished.solid;
  for (std::size_t place = 0; place < finished.labels.fragment.size(); ++place) {
    if (finished.labels.fragment[place] != id) {
      part.blocks.inside[place >> 6] &= ~(std::uint64_t{1} << (place & 63));
    }
  }
  part.blocks.outerBand.assign(part.blocks.outerBand.size(), 0);
  measureVoxels(part);
  return part;
}

SeededLabels breakPortion(const Solid& part, int id, const FractureOptions& options, Device& device,
                          const Progress* progress) {
  const std::uint64_t seed = randomBits(options.seed, Stage::again, static_cast<std::uint64_t>(id));
  const Parts parts = findParts(part.blocks, device);
  std::vector<Seed> seeds = placeSeeds(part, parts, seedOptionsFor(options, parts, seed));
  return growFor(options, part.blocks, parts, std::move(seeds), seed, device, progress);
}

}  // namespace

GrownFracture regrown(const FinishedFracture& finished, std::span<const int> only,
                      const FractureOptions& options, Device& device, const Progress* progress) {
  const std::set<int> broken(only.begin(), only.end());
  for (const int id : broken) {
    if (id < 1 || id > finished.fragments) {
      throw Error(ErrorCode::usage, "there is no fragment " + std::to_string(id) +
                                        ", the fracture has 1.." +
                                        std::to_string(finished.fragments));
    }
  }
  StageClock clock;
  GrownFracture all;
  FractureResult& result = all.result;
  result.solid = finished.solid;
  result.parts = findParts(finished.solid.blocks, device).count();
  result.labels.fragment.assign(finished.labels.fragment.size(), 0);
  std::vector<std::uint16_t> newId(static_cast<std::size_t>(finished.fragments) + 1, 0);
  for (int id = 1; id <= finished.fragments; ++id) {
    if (broken.count(id)) continue;
    result.parents.push_back(id);
    newId[static_cast<std::size_t>(id)] = static_cast<std::uint16_t>(result.parents.size());
  }
  finished.solid.blocks.forEachInside([&](std::size_t place) {
    result.labels.fragment[place] = newId[finished.labels.fragment[place]];
  });
  for (const int id : broken) {
    const Solid part = portion(finished, id);
    const SeededLabels grown = breakPortion(part, id, options, device, progress);
    const std::size_t first = result.parents.size();
    result.parents.insert(result.parents.end(), static_cast<std::size_t>(fragmentsOf(grown.seeds)),
                          id);
    if (result.parents.size() > kMaxFragments) {
      throw Error(ErrorCode::usage,
                  "there would be more than " + std::to_string(kMaxFragments) + " fragments");
    }
    part.blocks.forEachInside([&](std::size_t place) {
      result.labels.fragment[place] =
          static_cast<std::uint16_t>(first + grown.labels.fragment[place]);
    });
    for (Seed seed : grown.seeds) {
      seed.fragment = static_cast<std::uint16_t>(first + seed.fragment);
      result.seeds.push_back(seed);
    }
  }
  result.labels = carriedOverBand(finished.solid.blocks, std::move(result.labels), device,
                                  options.grow.outerSteps);
  result.worn.assign(result.parents.size() + 1, 0);
  clock.done("grow");
  result.times = clock.times();
  all.fragments = static_cast<int>(result.parents.size());
  return all;
}

FractureResult refracture(const FinishedFracture& finished, std::span<const int> only,
                          const FractureOptions& options, Device& device,
                          const Progress* progress) {
  return extracted(regrown(finished, only, options, device, progress), options, progress);
}

}  // namespace sherd
