// The options of stages, as a fracture fills them in.
#include "fracture_stages.h"

#include <algorithm>

#include "random.h"

namespace sherd {

SeedOptions seedOptionsFor(const FractureOptions& options, const Parts& parts, std::uint64_t seed) {
  SeedOptions seeds = options.seeds;
  seeds.pieces = options.pieces;
  seeds.seed = seed;
  const int fragments = std::max(options.pieces, static_cast<int>(parts.count()));
  seeds.extraSeeds += options.extraSeedsPerPiece * fragments;
  return seeds;
}

SeededLabels growFor(const FractureOptions& options, const LeafBlocks& blocks, const Parts& parts,
                     std::vector<Seed> seeds, std::uint64_t seed, Device& device,
                     const Progress* progress) {
  GrowOptions grow = options.grow;
  grow.noiseSeeds = {randomBits(seed, Stage::noise, 0)};
  return growWithShares(blocks, parts, std::move(seeds), device, grow, options.shares, seed,
                        progress);
}

}  // namespace sherd
