// Seed placement.  It takes one search per seed, so it runs on the host.
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "base/random.h"
#include "seed/impacts.h"
#include "seed/nearest_seed.h"
#include "seed/samplers.h"
#include "seed/voxel_index.h"

namespace sherd {
namespace {

// Returns a random permutation of 1..n (Fisher and Yates).
std::vector<std::uint16_t> permutedIds(std::size_t n, std::uint64_t seed) {
  std::vector<std::uint16_t> ids(n);
  std::iota(ids.begin(), ids.end(), std::uint16_t{1});
  for (std::size_t i = n; i > 1; --i) {
    std::swap(ids[i - 1], ids[randomBelow(i, seed, Stage::fragmentId, i)]);
  }
  return ids;
}

std::size_t countPieces(const VoxelComponents& components, const SeedOptions& options) {
  const std::size_t count = std::max(static_cast<std::size_t>(options.pieces), components.count());
  if (count > kMaxFragments) {
    throw Error(ErrorCode::usage,
                "the solid would give " + std::to_string(count) + " fragments; at most " +
                    std::to_string(kMaxFragments) + " are possible; try a lower resolution",
                OptionNames{"resolution"});
  }
  return count;
}

// Checks that the seeds of impacts and one seed per component fit into the number of pieces.
void checkImpactsFit(const std::vector<AimedImpact>& aimedImpacts,
                     const VoxelComponents& components, const SeedOptions& options) {
  std::size_t count = 0;
  for (const AimedImpact& aimedImpact : aimedImpacts)
    count += aimedImpact.merge ? 0 : aimedImpact.count;
  if (count == 0 || count + components.count() <= static_cast<std::size_t>(options.pieces)) return;
  throw Error(ErrorCode::usage,
              "the impacts make " + std::to_string(count) +
                  " pieces in addition to one for each of " + std::to_string(components.count()) +
                  " connected components, but the fracture has " + std::to_string(options.pieces) +
                  "; try more pieces, or let the impacts merge",
              OptionNames{"pieces"});
}

void checkRoom(std::size_t pieces, std::size_t further, const VoxelIndex& candidates,
               const SeedOptions& options) {
  if (pieces + further <= candidates.total()) return;
  const bool volume = options.on == SeedsOn::volume;
  throw Error(ErrorCode::usage,
              std::to_string(pieces) + " pieces" +
                  (further ? " and " + std::to_string(further) + " further seeds" : "") +
                  " do not fit into a solid of " + std::to_string(candidates.total()) +
                  (volume ? " voxels" : " surface voxels") + "; try a higher resolution" +
                  (volume ? "" : " or seeds in the volume"),
              volume ? OptionNames{"resolution"} : OptionNames{"resolution", "seeds-on"});
}

// Returns the chosen voxels as seeds: [those of `ids`, ascending by id][the rest, each with the id
// of the nearest of the former in its component].
std::vector<Seed> withIds(const Chosen& chosen, const std::vector<std::uint16_t>& ids,
                          const VoxelIndex& candidates, const VoxelComponents& components,
                          Metric metric) {
  std::vector<Seed> seeds(ids.size());
  std::vector<std::uint32_t> componentOfSeed(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    seeds[ids[i] - 1u] = {candidates.voxelAt(chosen.voxels[i]), ids[i]};
    componentOfSeed[ids[i] - 1u] = components.at(chosen.voxels[i]);
  }
  if (chosen.size() == ids.size()) return seeds;
  const NearestSeed nearest(seeds, componentOfSeed, components.count(), metric);
  for (std::size_t i = ids.size(); i < chosen.size(); ++i) {
    const openvdb::Coord voxel = candidates.voxelAt(chosen.voxels[i]);
    seeds.push_back({voxel, nearest.fragmentAt(voxel, components.at(chosen.voxels[i]))});
  }
  return seeds;
}

}  // namespace

int fragmentsOf(std::span<const Seed> seeds) {
  int highest = 0;
  for (const Seed& seed : seeds) highest = std::max<int>(highest, seed.fragment);
  return highest;
}

std::vector<Seed> placeSeeds(const Solid& solid, const VoxelComponents& components,
                             const SeedOptions& options) {
  if (options.pieces < 1) throw Error(ErrorCode::usage, "the number of pieces must be 1 or more");
  if (options.extraSeeds < 0 || options.extraSeedsPerPiece < 0 || options.randomImpacts < 0) {
    throw Error(ErrorCode::usage, "the number of extra seeds and of impacts must be 0 or more");
  }
  const std::size_t pieces = countPieces(components, options);
  const bool impacts = !options.impacts.empty() || options.randomImpacts > 0;
  std::vector<std::uint64_t> surface;
  if (impacts || options.on == SeedsOn::surface) surface = surfaceMask(*solid.blocks);
  const VoxelIndex inside(*solid.blocks, solid.blocks->inside);
  const VoxelIndex onSurface(*solid.blocks, surface);
  const VoxelIndex& candidates = options.on == SeedsOn::volume ? inside : onSurface;

  const auto extra = static_cast<std::size_t>(options.extraSeeds) +
                     static_cast<std::size_t>(options.extraSeedsPerPiece) * pieces;
  checkRoom(pieces, extra, candidates, options);
  const std::vector<AimedImpact> aimedImpacts =
      impacts ? aim(solid, components, options, pieces, inside, onSurface)
              : std::vector<AimedImpact>{};
  checkImpactsFit(aimedImpacts, components, options);
  const std::size_t merged = std::accumulate(
      aimedImpacts.begin(), aimedImpacts.end(), std::size_t{0},
      [](std::size_t sum, const AimedImpact& b) { return sum + (b.merge ? b.count : 0); });
  checkRoom(pieces, merged + extra, candidates, options);

  const std::vector<std::uint64_t> room = candidates.countInComponents(components);
  const auto scatterAll = [&](bool merge, Chosen& chosen) {
    for (std::size_t i = 0; i < aimedImpacts.size(); ++i) {
      if (aimedImpacts[i].merge != merge) continue;
      scatter(aimedImpacts[i], i, {candidates, solid.box, components, room}, options.seed, chosen);
    }
  };
  SeedSampler sampler(candidates, solid.box, options.sampler, options.seed);
  Chosen chosen;
  for (const VoxelKey key : onePerComponent(candidates, components, room, options.seed)) {
    chosen.add(key);
  }
  scatterAll(/*merge=*/false, chosen);
  sampler.draw(pieces - chosen.size(), chosen);
  scatterAll(/*merge=*/true, chosen);
  sampler.draw(extra, chosen);
  return withIds(chosen, permutedIds(pieces, options.seed), candidates, components,
                 options.mergeMetric);
}

}  // namespace sherd
