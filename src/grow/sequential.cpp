// Shares of fragments that splits are meant to give.
#include "grow/sequential.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/random.h"
#include "grow/shares.h"
#include "grow/split_plan.h"
#include "seed/sizes.h"

namespace sherd {
namespace {

// Returns the shares that the fragments of a fracture are meant to have.
std::vector<double> meantShares(std::size_t fragments, const GrowOptions& options,
                                const ShareOptions& shares, std::uint64_t voxels,
                                std::uint64_t seed) {
  constexpr double kMissed = 1.1;  // fragments miss their shares by some percent
  const double least = leastShareOf(shares, kMissed, fragments, voxels);
  if (shares.sizes == Sizes::grown) {
    return raisedTo(shares.minShare != 0.0 ? least : 0.0,
                    sharesOfSplits(options.split, fragments, seed));
  }
  return drawnShares(shares.sizes, shares.sizeParameter, fragments, least, seed);
}

std::uint64_t smallestOf(const Labels& labels) {
  const std::vector<std::uint64_t> voxels = countVoxels(labels);
  return *std::min_element(voxels.begin() + 1, voxels.end());
}

// Returns the greatest difference of a fragment's share from the one that it was meant to have,
// divided by that.
double sizeErrorOf(const SeededLabels& grown) {
  const std::vector<std::uint64_t> voxels = countVoxels(grown.labels);
  const auto all =
      static_cast<double>(std::accumulate(voxels.begin() + 1, voxels.end(), std::uint64_t{0}));
  double error = 0.0;
  for (std::size_t i = 0; i < grown.meantShares.size(); ++i) {
    const double share = static_cast<double>(voxels[i + 1]) / all;
    error = std::max(error, std::abs(share / grown.meantShares[i] - 1.0));
  }
  return error;
}

}  // namespace

std::vector<SeededLabels> growSequential(const Solid& solid, SolidWalls& walls,
                                         const VoxelComponents& components,
                                         std::span<const SequentialFracture> fractures,
                                         Device& device, const GrowOptions& options,
                                         const ShareOptions& shares, const GuideSides& guides,
                                         const Progress* progress) {
  const std::uint64_t voxels = solid.blocks->insideVoxels();
  const std::uint64_t least = leastVoxels(shares, voxels);
  const bool isDrawn = shares.sizes != Sizes::grown;
  const auto runOf = [&](std::size_t f, std::uint64_t seed) {
    const SequentialFracture& own = fractures[f];
    SplitRun run{meantShares(own.fragments, options, shares, voxels, seed), seed};
    if (own.on != SeedsOn::volume) run.walls = walls.normals();
    if (own.on == SeedsOn::wall) run.middles = walls.middles(progress);
    run.guides = &guides;
    if (isDrawn) return run;
    run.densities = own.densities;
    run.impacts = own.impacts;
    return run;
  };
  std::vector<SplitRun> runs;
  for (std::size_t f = 0; f < fractures.size(); ++f) {
    checkShares(shares, components, static_cast<int>(fractures[f].fragments), voxels);
    runs.push_back(runOf(f, fractures[f].seed));
  }
  std::vector<SeededLabels> all =
      growBySplits(solid.blocks, components, runs, device, options, progress);
  for (std::size_t f = 0; f < all.size() && least > 0; ++f) {
    GrowOptions own = options;
    if (f < options.noiseSeeds.size()) own.noiseSeeds = {options.noiseSeeds[f]};
    std::uint64_t smallest = smallestOf(all[f].labels);
    for (int attempt = 1; smallest < least; ++attempt) {
      if (attempt >= std::max(shares.tries, 1)) {
        throw unreachedShare(shares, static_cast<int>(fractures[f].fragments), smallest, voxels,
                             true);
      }
      const SplitRun again = runOf(
          f, randomBits(fractures[f].seed, Stage::reseed, static_cast<std::uint64_t>(attempt)));
      all[f] = std::move(
          growBySplits(solid.blocks, components, std::span(&again, 1), device, own, progress)
              .front());
      smallest = smallestOf(all[f].labels);
    }
  }
  for (SeededLabels& each : all) {
    each.guide = guides.guide;
    if (isDrawn) each.sizeError = sizeErrorOf(each);
  }
  return all;
}

}  // namespace sherd
