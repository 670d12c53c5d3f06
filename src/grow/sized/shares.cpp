// Sizes of fragments.  Every attempt grows from seeds again, so the result equals one plain growth.
#include "grow/sized/shares.h"

#include <sherd/error.h>
#include <sherd/growth.h>
#include <sherd/labels.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "base/random.h"
#include "grow/sized/raise_small.h"
#include "grow/sized/sized_growth.h"
#include "seed/draw/distinct_middles.h"
#include "seed/draw/samplers.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

void checkSizes(const ShareOptions& options, const GrowOptions& grow) {
  const GrowthRule& rule = ruleOf(grow.growth);
  if (options.sizes == Sizes::grown || rule.splits || givesCells(grow)) return;
  throw Error(ErrorCode::usage,
              std::string("fragments of drawn sizes have planes between weighted seeds, which "
                          "growth by ") +
                  rule.name +
                  " does not; try growth by euclid, or by nearest with the Euclidean "
                  "metric",
              OptionNames{"growth", "sizes"});
}

// Returns `small` without fragments whose component of the solid would lose its last seed.
std::vector<std::uint16_t> removableFragments(const LeafBlocks& blocks,
                                              const VoxelComponents& components,
                                              const std::vector<Seed>& seeds,
                                              std::vector<std::uint16_t> small) {
  const auto componentOf = [&](const Seed& s) {
    return components.at(std::size_t{findLeaf(blocks, s.voxel)} * 512 + offsetFromCoord(s.voxel));
  };
  const std::set<std::uint16_t> removed(small.begin(), small.end());
  std::set<std::uint32_t> seeded;
  for (const Seed& s : seeds) {
    if (!removed.count(s.fragment)) seeded.insert(componentOf(s));
  }
  std::erase_if(
      small, [&](std::uint16_t id) { return seeded.insert(componentOf(seeds[id - 1u])).second; });
  return small;
}

// A seed that is to be placed in fragment `from`.
struct NewSeed {
  std::uint16_t from, id;
  std::uint64_t rank = 0;  // of the voxel in leaf order within the fragment
};

// Places new seeds at random points of their fragments; returns those for which none was found.
//   item  number of a new seed's draws
std::vector<NewSeed> placeAtPoints(const Solid& solid, const Labels& labels,
                                   const std::vector<NewSeed>& newSeeds, std::uint64_t seed,
                                   const DensityTest& density,
                                   const std::function<std::uint64_t(std::uint16_t)>& item,
                                   std::set<openvdb::Coord>& occupied, std::vector<Seed>& seeds) {
  const VoxelIndex inside(*solid.blocks, solid.blocks->inside);
  const Candidates candidates(solid, inside, SeedsOn::volume);
  std::vector<NewSeed> left;
  std::uint64_t budget = 1 << 22;  // draws of all: a second of work at most
  for (const NewSeed& newSeed : newSeeds) {
    std::optional<Seed> found;
    // Some 4,096 points of the solid: the largest fragment mostly has far more than a thousandth.
    const std::uint64_t draws = std::min(budget, 64 * candidates.drawsForOne());
    for (std::uint64_t i = 0; i < draws && !found; ++i) {
      --budget;
      const std::uint64_t number = drawItem(item(newSeed.id), i);
      const glm::dvec3 point = randomPoint(seed, Stage::reseedPoint, number);
      const auto at = candidates.inBox(point);
      if (!at || !at->key || labels.fragment[*at->key] != newSeed.from) continue;
      if (!density.accepts(candidates.pointInBox(point), number)) continue;
      const openvdb::Coord voxel = inside.voxelAt(*at->key);
      if (occupied.insert(voxel).second) found = Seed{voxel, newSeed.id, at->shift};
    }
    if (found)
      seeds[newSeed.id - 1u] = *found;
    else
      left.push_back(newSeed);
  }
  return left;
}

// Places new seeds at the voxels of their ranks, in one pass over the solid.
void placeAtRanks(const Labels& labels, std::size_t fragments, const std::vector<NewSeed>& newSeeds,
                  std::set<openvdb::Coord>& occupied, std::vector<Seed>& seeds) {
  if (newSeeds.empty()) return;
  std::vector<std::vector<NewSeed>> newSeedsIn(fragments + 1);
  for (const NewSeed& newSeed : newSeeds) newSeedsIn[newSeed.from].push_back(newSeed);
  std::vector<std::uint64_t> visited(fragments + 1, 0);
  labels.blocks->forEachInside([&](std::size_t voxelIndex) {
    const std::uint16_t label = labels.fragment[voxelIndex];
    if (label == 0) return;
    const std::uint64_t rank = visited[label]++;
    for (NewSeed& newSeed : newSeedsIn[label]) {
      if (newSeed.rank != rank) continue;
      const openvdb::Coord voxel = labels.blocks->voxelAt(voxelIndex);
      if (!occupied.insert(voxel).second) {
        ++newSeed.rank;  // occupied by another seed: take the next voxel of the fragment
      } else {
        seeds[newSeed.id - 1u] = {voxel, newSeed.id};
      }
    }
  });
}

// Replaces the seeds of each `small` fragment by one new seed in the largest remaining fragment.
//   voxels   [fragments + 1] of `labels`
//   attempt  draws are its own, and each fragment's
void reseed(const Solid& solid, const Labels& labels, std::vector<Seed>& seeds,
            const std::vector<std::uint16_t>& small, std::vector<std::uint64_t> voxels,
            std::uint64_t seed, const DensityTest& density, int attempt) {
  const std::set<std::uint16_t> removed(small.begin(), small.end());
  const std::size_t primaries = voxels.size() - 1;
  std::erase_if(seeds, [&, i = std::size_t{0}](const Seed& s) mutable {
    return i++ >= primaries && removed.count(s.fragment);  // additional seeds of a removed fragment
  });
  std::set<openvdb::Coord> occupied;
  for (const Seed& s : seeds) occupied.insert(s.voxel);
  const auto item = [&](std::uint16_t id) {
    return static_cast<std::uint64_t>(attempt) << 16 | id;
  };
  const std::vector<std::uint64_t> size = voxels;
  std::vector<NewSeed> newSeeds;
  for (const std::uint16_t id : small) {
    const auto largest = static_cast<std::size_t>(
        std::max_element(voxels.begin() + 1, voxels.end()) - voxels.begin());
    voxels[largest] /= 2;
    voxels[id] = voxels[largest];
    newSeeds.push_back({static_cast<std::uint16_t>(largest), id,
                        randomBelow(size[largest], seed, Stage::reseed, item(id))});
  }
  placeAtRanks(labels, primaries,
               placeAtPoints(solid, labels, newSeeds, seed, density, item, occupied, seeds),
               occupied, seeds);
}

}  // namespace

SeededLabels growWithShares(const Solid& solid, const VoxelComponents& components,
                            std::vector<Seed> seeds, Device& device,
                            const SharedGrowthOptions& options, const Progress* progress) {
  const std::shared_ptr<const LeafBlocks>& blocks = solid.blocks;
  const ShareOptions& shares = options.shares;
  const int fragments = fragmentsOf(seeds);
  const std::uint64_t voxels = blocks->insideVoxels();
  checkShares(shares, components, fragments, voxels);
  checkSizes(shares, options.grow);
  const std::uint64_t minVoxels = leastVoxels(shares, voxels);
  const auto growFrom = [&](const std::vector<Seed>& from) {
    return std::move(grow(blocks, std::span(&from, 1), device, options.grow, progress).front());
  };
  // Seeds that were placed or moved, with middles of their own in walls.
  const auto apart = [&](std::vector<Seed> moved) {
    const std::shared_ptr<const WallMiddles> walls =
        options.grow.walls.empty() ? nullptr : options.grow.walls.front();
    return walls ? withDistinctMiddles(std::move(moved), *blocks, *walls) : std::move(moved);
  };
  constexpr int kTriesBeforeCentering = 8;
  const DensityTest density(options.density, solid.frame, options.seed);

  seeds = apart(std::move(seeds));
  Labels labels = growFrom(seeds);
  for (int i = 0; i < shares.balance; ++i) {
    seeds = apart(centeredSeeds(labels, std::move(seeds)));
    labels = growFrom(seeds);
  }
  if (shares.sizes != Sizes::grown) {
    return grownToSizes(solid, components, std::move(seeds), device, options, progress);
  }
  std::uint64_t smallest = 0;
  for (int attempt = 0; attempt < std::max(shares.tries, 1); ++attempt) {
    const std::vector<std::uint64_t> counts = countVoxels(labels);
    smallest = *std::min_element(counts.begin() + 1, counts.end());
    if (smallest >= minVoxels) return {std::move(seeds), std::move(labels)};
    std::vector<std::uint16_t> small;
    for (int id = 1; id <= fragments; ++id) {
      if (counts[static_cast<std::size_t>(id)] < minVoxels) {
        small.push_back(static_cast<std::uint16_t>(id));
      }
    }
    reseed(solid, labels, seeds, removableFragments(*blocks, components, seeds, std::move(small)),
           counts, options.seed, density, attempt);
    seeds = apart(std::move(seeds));
    labels = growFrom(seeds);
    if (attempt < kTriesBeforeCentering) continue;
    seeds = apart(centeredSeeds(labels, std::move(seeds)));
    labels = growFrom(seeds);
  }
  throw unreachedShare(shares, fragments, smallest, voxels, false);
}

}  // namespace sherd
