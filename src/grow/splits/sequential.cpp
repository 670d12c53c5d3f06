// Shares of fragments that splits are meant to give.
#include "grow/splits/sequential.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/random.h"
#include "grow/sized/shares.h"
#include "grow/sized/split_plan.h"
#include "seed/draw/sizes.h"

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

// Runs of fractures, decided on one solid and made of the voxels of another or the same.
class Runs {
 public:
  Runs(const Solid& solid, SolidWalls& walls, const VoxelComponents& components,
       const GuideSides& guides, const DecidingSolid* deciding, Device& device,
       const GrowOptions& options, const ShareOptions& shares, const Progress* progress)
      : solid_(solid),
        walls_(walls),
        components_(components),
        guides_(guides),
        deciding_(deciding),
        device_(device),
        options_(options),
        shares_(shares),
        progress_(progress) {}

  // Returns the fractures with these seeds.
  //   seeds  [fractures]
  //   grow   how they grow, with the noise of each
  std::vector<SeededLabels> grown(std::span<const SequentialFracture> fractures,
                                  std::span<const std::uint64_t> seeds, const GrowOptions& grow) {
    std::vector<SplitRun> runs;
    const std::vector<GivenSplits> given = decided(fractures, seeds);
    leastDecided_.assign(fractures.size(), solid_.voxels);
    for (std::size_t f = 0; f < fractures.size(); ++f) {
      if (!fractures[f].isDecidedElsewhere) {
        runs.push_back(runOf(fractures[f], seeds[f], solid_, walls_, guides_));
        continue;
      }
      runs.push_back({given[f].shares, seeds[f]});
      if (fractures[f].on == SeedsOn::wall) runs.back().middles = walls_.middles(progress_);
      runs.back().guides = &guides_;
      runs.back().given = &given[f];
      leastDecided_[f] = given[f].leastVoxels;
    }
    return growBySplits(solid_.blocks, components_, runs, device_, grow, progress_);
  }

  // Returns for each fracture that was grown last whether its splits, where they were decided,
  // leave each fragment its least share.
  std::vector<bool> areDecidedAbove() const {
    const std::uint64_t least =
        deciding_ != nullptr ? leastVoxels(shares_, deciding_->solid.voxels) : 0;
    std::vector<bool> all;
    for (const std::uint64_t voxels : leastDecided_) all.push_back(voxels >= least);
    return all;
  }

 private:
  // [fractures] the splits of those that are decided elsewhere
  std::vector<GivenSplits> decided(std::span<const SequentialFracture> fractures,
                                   std::span<const std::uint64_t> seeds) {
    std::vector<GivenSplits> all(fractures.size());
    std::vector<SplitRun> runs;
    std::vector<std::size_t> which;
    for (std::size_t f = 0; f < fractures.size(); ++f) {
      if (!fractures[f].isDecidedElsewhere) continue;
      runs.push_back(
          runOf(fractures[f], seeds[f], deciding_->solid, deciding_->walls, deciding_->guides));
      which.push_back(f);
    }
    if (runs.empty()) return all;
    const std::vector<GivenSplits> found = decideSplits(
        *deciding_->solid.blocks, deciding_->components, runs, device_, options_, progress_);
    const VoxelScale scale = VoxelScale::between(deciding_->solid, solid_);
    for (std::size_t i = 0; i < found.size(); ++i) {
      all[which[i]] = givenFor(found[i], scale, deciding_->component);
    }
    return all;
  }

  SplitRun runOf(const SequentialFracture& own, std::uint64_t seed, const Solid& solid,
                 SolidWalls& walls, const GuideSides& guides) {
    SplitRun run{meantShares(own.fragments, options_, shares_, solid.voxels, seed), seed};
    if (own.on != SeedsOn::volume) run.walls = walls.normals();
    if (own.on == SeedsOn::wall) run.middles = walls.middles(progress_);
    run.guides = &guides;
    if (shares_.sizes != Sizes::grown) return run;
    run.densities = own.densities;
    run.impacts = own.impacts;
    return run;
  }

  const Solid& solid_;
  SolidWalls& walls_;
  const VoxelComponents& components_;
  const GuideSides& guides_;
  const DecidingSolid* deciding_;
  Device& device_;
  const GrowOptions& options_;
  const ShareOptions& shares_;
  const Progress* progress_;
  std::vector<std::uint64_t> leastDecided_{};  // voxels of the smallest fragments
};

}  // namespace

std::vector<SeededLabels> growSequential(const Solid& solid, SolidWalls& walls,
                                         const VoxelComponents& components,
                                         std::span<const SequentialFracture> fractures,
                                         Device& device, const GrowOptions& options,
                                         const ShareOptions& shares, const GuideSides& guides,
                                         const DecidingSolid* deciding, const Progress* progress) {
  const std::uint64_t voxels = solid.voxels;
  const std::uint64_t least = leastVoxels(shares, voxels);
  std::vector<std::uint64_t> seeds;
  for (const SequentialFracture& each : fractures) {
    checkShares(shares, components, static_cast<int>(each.fragments), voxels);
    seeds.push_back(each.seed);
  }
  Runs runs(solid, walls, components, guides, deciding, device, options, shares, progress);
  std::vector<SeededLabels> all = runs.grown(fractures, seeds, options);
  const std::vector<bool> areAbove = runs.areDecidedAbove();
  for (std::size_t f = 0; f < all.size() && least > 0; ++f) {
    GrowOptions own = options;
    if (f < options.noiseSeeds.size()) own.noiseSeeds = {options.noiseSeeds[f]};
    if (f < options.noiseAnchors.size()) own.noiseAnchors = {options.noiseAnchors[f]};
    std::uint64_t smallest = smallestOf(all[f].labels);
    bool isAbove = areAbove[f];
    for (int attempt = 1; smallest < least || !isAbove; ++attempt) {
      if (attempt >= std::max(shares.tries, 1)) {
        if (smallest >= least) break;
        throw unreachedShare(shares, static_cast<int>(fractures[f].fragments), smallest, voxels,
                             true);
      }
      const std::uint64_t seed =
          randomBits(fractures[f].seed, Stage::reseed, static_cast<std::uint64_t>(attempt));
      all[f] = std::move(runs.grown(fractures.subspan(f, 1), std::span(&seed, 1), own).front());
      smallest = smallestOf(all[f].labels);
      isAbove = runs.areDecidedAbove().front();
    }
  }
  for (SeededLabels& each : all) {
    each.guide = guides.guide;
    if (shares.sizes != Sizes::grown) each.sizeError = sizeErrorOf(each);
  }
  return all;
}

}  // namespace sherd
