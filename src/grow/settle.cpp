// Points of seeds whose voxels are theirs.
#include "grow/settle.h"

#include "seed/nearest_seed.h"

namespace sherd {
namespace {

Metric kindOf(const sherd_metric& metric) {
  return metric.kind == SHERD_EUCLIDEAN   ? Metric::euclidean
         : metric.kind == SHERD_CHEBYSHEV ? Metric::chebyshev
                                          : Metric::manhattan;
}

}  // namespace

glm::i64vec3 stretched(const sherd_metric& metric, const glm::i64vec3& steps) {
  glm::i64vec3 out;
  for (int i = 0; i < 3; ++i) {
    out[i] = metric.row[3 * i] * steps.x + metric.row[3 * i + 1] * steps.y +
             metric.row[3 * i + 2] * steps.z;
  }
  return out;
}

std::vector<Seed> settled(std::span<const Seed> seeds, const sherd_metric& metric) {
  std::vector<Seed> out(seeds.begin(), seeds.end());
  // A seed that moves may be nearer to the center of another's voxel than before, so this is done
  // again until nothing moves; seeds that are at their centers stay, so it ends.
  // Drawn seeds take two passes; where many lie in a row that each move the next, all move.
  constexpr int kMostPasses = 8;
  bool moved = true;
  for (int pass = 0; moved && pass < kMostPasses; ++pass) {
    moved = false;
    std::vector<NearestSeed::Site> sites;
    for (const Seed& seed : out)
      sites.push_back({stretched(metric, stepsOf(seed)), seed.fragment, 0});
    const NearestSeed nearest(std::move(sites), 1, kindOf(metric));
    for (Seed& seed : out) {
      if (seed.shift == glm::ivec3(0)) continue;
      const Seed center{seed.voxel, seed.fragment};
      if (nearest.fragmentAt(stretched(metric, stepsOf(center)), 0) == seed.fragment) continue;
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
