// Seed placement.  It takes one search per seed, so it runs on the host.
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "base/random.h"
#include "seed/draw/irwin_hall.h"
#include "seed/draw/samplers.h"
#include "seed/draw/voxel_index.h"
#include "seed/draw/wall.h"
#include "seed/fragment_ids.h"
#include "seed/impacts.h"
#include "seed/nearest_seed.h"

namespace sherd {
namespace {

// Fits the seeds of impacts and one seed per component into the number of pieces: where impacts
// have all pieces, theirs include those of the components, and the last ones have fewer seeds.
void fitImpacts(std::vector<AimedImpact>& aimedImpacts, const VoxelComponents& components,
                const SeedOptions& options) {
  const auto pieces = static_cast<std::size_t>(options.pieces);
  std::size_t count = 0;
  for (const AimedImpact& aimedImpact : aimedImpacts)
    count += aimedImpact.merge ? 0 : aimedImpact.count;
  if (count == 0 || count + components.count() <= pieces) return;
  std::size_t surplus = count + components.count() - pieces;
  for (std::size_t i = aimedImpacts.size(); count <= pieces && surplus > 0 && i-- > 0;) {
    if (aimedImpacts[i].merge) continue;
    const std::size_t less = std::min(surplus, aimedImpacts[i].count);
    aimedImpacts[i].count -= less;
    surplus -= less;
  }
  if (surplus == 0) return;
  throw Error(ErrorCode::usage,
              "the impacts make " + std::to_string(count) + " pieces of a solid of " +
                  std::to_string(components.count()) +
                  (components.count() == 1 ? " component" : " components") +
                  ", but the fracture has " + std::to_string(options.pieces) +
                  "; try more pieces, or let the impacts merge",
              OptionNames{"pieces"});
}

void checkRoom(std::size_t pieces, std::size_t further, const VoxelIndex& candidates,
               const SeedOptions& options) {
  if (pieces + further <= candidates.total()) return;
  const bool volume = options.on != SeedsOn::surface;
  throw Error(ErrorCode::usage,
              std::to_string(pieces) + " pieces" +
                  (further ? " and " + std::to_string(further) + " further seeds" : "") +
                  " do not fit into a solid of " + std::to_string(candidates.total()) +
                  (volume ? " voxels" : " surface voxels") + "; try a higher resolution" +
                  (volume ? "" : " or seeds in the volume"),
              volume ? OptionNames{"resolution"} : OptionNames{"resolution", "seeds-on"});
}

// 2^x, linear between whole x: the last bits of exp2 differ between machines.
double powerOfTwo(double x) {
  const double whole = std::floor(x);
  return std::ldexp(1.0 + (x - whole), static_cast<int>(whole));
}

// By what the order of distances to a fragment is divided: SeedOptions::sizeSpread.
double scaleOf(std::uint16_t id, const SeedOptions& options) {
  if (options.sizeSpread == 0.0) return 1.0;
  // The mean of 12 uniforms has a standard deviation of 1/12.
  const double normal =
      kNormalTerms * meanOfUniforms(kNormalTerms, options.seed, Stage::fragmentReach, id);
  const double reach = powerOfTwo(options.sizeSpread * normal);
  return options.mergeMetric == Metric::euclidean ? reach * reach : reach;
}

// Returns the chosen candidates as seeds: [those of `ids`, ascending by id][the rest, each with the
// id of the nearest of the former in its component].
std::vector<Seed> withIds(const Chosen& chosen, const std::vector<std::uint16_t>& ids,
                          const VoxelIndex& voxels, const VoxelComponents& components,
                          const SeedOptions& options) {
  std::vector<Seed> seeds(ids.size());
  std::vector<NearestSeed::Site> sites;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Candidate& own = chosen.all()[i];
    seeds[ids[i] - 1u] = {voxels.voxelAt(*own.key), ids[i], own.shift};
    sites.push_back({own.inSpace, ids[i], components.at(*own.key), scaleOf(ids[i], options)});
  }
  if (chosen.size() == ids.size()) return seeds;
  const NearestSeed nearest(std::move(sites), components.count(), options.mergeMetric);
  for (std::size_t i = ids.size(); i < chosen.size(); ++i) {
    const Candidate& own = chosen.all()[i];
    seeds.push_back({voxels.voxelAt(*own.key),
                     nearest.fragmentAt(own.inSpace, components.at(*own.key)), own.shift});
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
                             const SeedOptions& options, const Progress* progress) {
  if (options.pieces < 1) throw Error(ErrorCode::usage, "the number of pieces must be 1 or more");
  if (options.extraSeeds < 0 || options.extraSeedsPerPiece < 0 || options.randomImpacts < 0) {
    throw Error(ErrorCode::usage, "the number of extra seeds and of impacts must be 0 or more");
  }
  if (!(options.sizeSpread >= 0.0 && options.sizeSpread <= kMostSizeSpread)) {
    throw Error(ErrorCode::usage, "the spread of sizes must lie in 0..4");
  }
  if (options.density.field && options.sampler == Sampler::poisson) {
    throw Error(ErrorCode::usage,
                "poisson keeps seeds apart by one distance, which a density of pieces does not "
                "have; choose another sampler",
                OptionNames{"sampler", "density-attribute"});
  }
  const std::size_t pieces = countFragments(components, options.pieces);
  const SeedsOn on = resolved(options.on, solid, pieces);
  const bool impacts = !options.impacts.empty() || options.randomImpacts > 0;
  std::vector<std::uint64_t> surface;
  if (impacts || on == SeedsOn::surface) surface = surfaceMask(*solid.blocks);
  const VoxelIndex inside(*solid.blocks, solid.blocks->inside);
  const VoxelIndex onSurface(*solid.blocks, surface);
  const VoxelIndex& voxels = on == SeedsOn::surface ? onSurface : inside;
  const Candidates candidates(solid, voxels, on, thinFor(solid, pieces));

  const auto extra = static_cast<std::size_t>(options.extraSeeds) +
                     static_cast<std::size_t>(options.extraSeedsPerPiece) * pieces;
  checkRoom(pieces, extra, voxels, options);
  std::vector<AimedImpact> aimedImpacts =
      impacts ? aim(solid, components, options, pieces, inside, onSurface, progress)
              : std::vector<AimedImpact>{};
  fitImpacts(aimedImpacts, components, options);
  const std::size_t merged = std::accumulate(
      aimedImpacts.begin(), aimedImpacts.end(), std::size_t{0},
      [](std::size_t sum, const AimedImpact& b) { return sum + (b.merge ? b.count : 0); });
  checkRoom(pieces, merged + extra, voxels, options);

  const std::vector<std::uint64_t> room = voxels.countInComponents(components);
  const auto scatterAll = [&](bool merge, Chosen& chosen) {
    for (std::size_t i = 0; i < aimedImpacts.size(); ++i) {
      if (aimedImpacts[i].merge != merge) continue;
      scatter(aimedImpacts[i], i, candidates, room[aimedImpacts[i].component], options.seed, chosen,
              progress);
    }
  };
  const DensityTest density(options.density.field.get(), solid.frame, options.seed);
  SeedSampler sampler(candidates, options.sampler, options.seed, density, progress);
  Chosen chosen(components);
  scatterAll(/*merge=*/false, chosen);
  sampler.draw(pieces - chosen.size(), chosen);
  scatterAll(/*merge=*/true, chosen);
  sampler.draw(extra, chosen);
  return withIds(chosen, permutedIds(pieces, options.seed), voxels, components, options);
}

}  // namespace sherd
