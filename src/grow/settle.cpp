// Points of seeds whose voxels are theirs.
#include "grow/settle.h"

#include "grow/metric.h"
#include "seed/nearest_seed.h"

namespace sherd {

std::vector<Seed> settled(std::span<const Seed> seeds, Metric metric,
                          const Anisotropy& anisotropy) {
  const sherd_metric matrix = metricFor(metric, anisotropy);
  std::vector<Seed> out(seeds.begin(), seeds.end());
  // A seed that moves may be nearer to the center of another's voxel than before, so this is done
  // again until nothing moves.  Drawn seeds take two passes; where many lie in a row that each move
  // the next, all move.
  constexpr int kMostPasses = 8;
  bool moved = true;
  for (int pass = 0; moved && pass < kMostPasses; ++pass) {
    moved = false;
    std::vector<NearestSeed::Site> sites;
    for (const Seed& seed : out)
      sites.push_back({stretched(matrix, stepsOf(seed)), seed.fragment, 0});
    const NearestSeed nearest(std::move(sites), 1, metric);
    for (Seed& seed : out) {
      if (seed.shift == glm::ivec3(0)) continue;
      const Seed center{seed.voxel, seed.fragment};
      if (nearest.fragmentAt(stretched(matrix, stepsOf(center)), 0) == seed.fragment) continue;
      seed = center;
      moved = true;
    }
  }
  if (moved) {
    for (Seed& seed : out) seed.shift = glm::ivec3(0);
  }
  return out;
}

}  // namespace sherd
