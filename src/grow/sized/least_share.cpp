// What shares of growths are meant and kept.
#include "grow/sized/least_share.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "base/random.h"
#include "grow/sized/raise_small.h"
#include "seed/draw/distinct_middles.h"
#include "seed/draw/samplers.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100.0 * share);
  return text;
}

}  // namespace

std::vector<Seed> centeredSeeds(const Labels& labels, std::vector<Seed> seeds) {
  struct Centroid {
    std::array<std::int64_t, 3> position{};  // the sum of coordinates, then in steps of seeds
    std::int64_t count = 0;
    std::int64_t leastDistance = -1;  // squared, of `nearest`
    openvdb::Coord nearest;
  };
  std::size_t fragments = 0;
  for (const Seed& seed : seeds) fragments = std::max<std::size_t>(fragments, seed.fragment);
  std::vector<Centroid> centroids(fragments + 1);
  labels.blocks->forEachInside([&](std::size_t voxelIndex) {
    const std::uint16_t label = labels.fragment[voxelIndex];
    if (label == 0 || label > fragments) return;
    const openvdb::Coord voxel = labels.blocks->voxelAt(voxelIndex);
    for (std::size_t i = 0; i < 3; ++i) centroids[label].position[i] += voxel[static_cast<int>(i)];
    ++centroids[label].count;
  });
  for (Centroid& centroid : centroids) {
    for (std::int64_t& c : centroid.position) {
      c *= 2 * kSeedSteps;
      if (centroid.count > 0)
        c = (c + (c < 0 ? -centroid.count : centroid.count)) / (2 * centroid.count);
    }
  }
  std::set<openvdb::Coord> additional;  // seeds that stay
  for (std::size_t i = fragments; i < seeds.size(); ++i) additional.insert(seeds[i].voxel);
  labels.blocks->forEachInside([&](std::size_t voxelIndex) {
    const std::uint16_t label = labels.fragment[voxelIndex];
    if (label == 0 || label > fragments) return;
    Centroid& centroid = centroids[label];
    const openvdb::Coord voxel = labels.blocks->voxelAt(voxelIndex);
    std::int64_t distance = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int64_t d = kSeedSteps * voxel[static_cast<int>(i)] - centroid.position[i];
      distance += d * d;
    }
    if ((centroid.leastDistance >= 0 && distance >= centroid.leastDistance) ||
        additional.count(voxel))
      return;
    centroid.leastDistance = distance;
    centroid.nearest = voxel;
  });
  for (std::size_t i = 0; i < fragments; ++i) {
    const Centroid& centroid = centroids[seeds[i].fragment];
    if (centroid.leastDistance < 0) continue;
    seeds[i].voxel = centroid.nearest;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t off = centroid.position[static_cast<std::size_t>(axis)] -
                               std::int64_t{kSeedSteps} * centroid.nearest[axis];
      seeds[i].shift[axis] =
          static_cast<int>(std::clamp<std::int64_t>(off, -kMostShift, kMostShift));
    }
  }
  return seeds;
}

void checkShares(const ShareOptions& options, const VoxelComponents& components, int fragments,
                 std::uint64_t voxels) {
  if (!((options.minShare >= 0.0 && options.minShare <= 1.0) || options.minShare == kAutoShare)) {
    throw Error(ErrorCode::usage, "the least share must lie in 0..1");
  }
  if (options.balance < 0 || options.balance > 100) {
    throw Error(ErrorCode::usage, "the balance steps must lie in 0..100");
  }
  if (options.minShare * fragments > 1.0) {
    throw Error(ErrorCode::usage, std::to_string(fragments) + " fragments cannot each have " +
                                      percent(options.minShare) + " of the solid");
  }
  for (const std::uint64_t component : components.voxels()) {
    const double share = static_cast<double>(component) / static_cast<double>(voxels);
    if (share >= options.minShare) continue;
    throw Error(ErrorCode::usage, "a component of the solid has " + percent(share) +
                                      " of its volume, so no fragment there can have at least " +
                                      percent(options.minShare));
  }
}

std::uint64_t leastVoxels(const ShareOptions& options, std::uint64_t voxels) {
  if (options.minShare == kAutoShare) return 0;  // raiseSmallFragments gives them more
  return static_cast<std::uint64_t>(
      std::ceil(options.minShare * static_cast<double>(voxels) - 1e-9));
}

double leastShareOf(const ShareOptions& options, double above, std::size_t fragments,
                    std::uint64_t voxels) {
  // A crack divides eight voxels as well as any, and sizes are met within as many.
  constexpr double kFewVoxels = 8.0;
  const double room = 1.0 / static_cast<double>(std::max<std::size_t>(fragments, 1));
  const double fewest = options.minShare == kAutoShare
                            ? kFewVoxels + static_cast<double>(leastVoxelsOf(voxels, fragments))
                            : kFewVoxels;
  const double few = std::min(fewest / static_cast<double>(voxels), 0.5 * room);
  return std::min(std::max(few, above * options.minShare), std::max(room, options.minShare));
}

Error unreachedShare(const ShareOptions& options, int fragments, std::uint64_t smallest,
                     std::uint64_t voxels, bool splits) {
  return Error(ErrorCode::usage,
               "no " + std::to_string(fragments) + " fragments of at least " +
                   percent(options.minShare) + " were found in " + std::to_string(options.tries) +
                   " growths, the smallest had " +
                   percent(static_cast<double>(smallest) / static_cast<double>(voxels)) +
                   "; try fewer pieces" + (splits ? ", or smoother cracks" : ", or a balance of 8"),
               splits ? OptionNames{"pieces", "roughness"} : OptionNames{"pieces", "balance"});
}

}  // namespace sherd
