// Points of seeds whose voxels are theirs.
#include "grow/fields/settle.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include "grow/fields/metric.h"
#include "seed/nearest_seed.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// Finds the seed of the least squared distance minus weight.
class LeastPower {
 public:
  LeastPower(std::span<const Seed> seeds, const sherd_metric& metric) : seeds_(seeds) {
    order_.resize(seeds.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    for (const Seed& seed : seeds) {
      at_.push_back(stretched(metric, stepsOf(seed)));
      weight_.push_back(weightIn(metric, seed.weight));
      mostWeight_ = std::max(mostWeight_, weight_.back());
    }
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return at_[a].x < at_[b].x; });
  }

  std::int64_t power(std::size_t seed, const glm::i64vec3& point) const {
    const glm::i64vec3 d = point - at_[seed];
    return d.x * d.x + d.y * d.y + d.z * d.z - weight_[seed];
  }

  // Returns the seed at a point; ties go to the lower fragment.  Seeds are visited from the point's
  // x to both sides, as far as the greatest weight could make up for the distance.
  std::size_t at(const glm::i64vec3& point) const {
    const auto from = std::lower_bound(order_.begin(), order_.end(), point.x,
                                       [&](std::size_t i, std::int64_t x) { return at_[i].x < x; });
    std::size_t best = order_.front();
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    const auto visit = [&](std::size_t i) {
      const std::int64_t dx = point.x - at_[i].x;
      if (least != std::numeric_limits<std::int64_t>::max() && dx * dx - mostWeight_ > least) {
        return false;
      }
      const std::int64_t own = power(i, point);
      if (own < least || (own == least && seeds_[i].fragment < seeds_[best].fragment)) {
        least = own;
        best = i;
      }
      return true;
    };
    for (auto up = from; up != order_.end() && visit(*up); ++up) {
    }
    for (auto down = from; down != order_.begin() && visit(*std::prev(down)); --down) {
    }
    return best;
  }

 private:
  std::span<const Seed> seeds_;
  std::vector<std::size_t> order_;  // by x
  std::vector<glm::i64vec3> at_;
  std::vector<std::int64_t> weight_;
  std::int64_t mostWeight_ = std::numeric_limits<std::int64_t>::min();
};

// The shifts from voxels to the points that are compared with seeds: [seeds].
std::vector<glm::ivec3> centersOf(std::span<const Seed> seeds, const WallMiddles* walls) {
  std::vector<glm::ivec3> centers(seeds.size(), glm::ivec3(0));
  for (std::size_t i = 0; i < seeds.size() && walls != nullptr; ++i) {
    const std::uint32_t leaf = findLeaf(walls->blocks(), seeds[i].voxel);
    if (leaf == LeafBlocks::kNone) continue;
    centers[i] = walls->wayAt(std::size_t{leaf} * 512 + offsetFromCoord(seeds[i].voxel));
  }
  return centers;
}

Seed moved(const Seed& seed, const glm::ivec3& shift) {
  Seed at = seed;
  at.shift = shift;
  return at;
}

// Of seeds with weights.  A seed at its voxel's center that another still outweighs there lowers
// the other's weight: it ends, because equal weights need no lowering.  Nothing after kMostPasses.
std::optional<std::vector<Seed>> settledWeights(std::span<const Seed> seeds,
                                                std::span<const glm::ivec3> centers,
                                                const sherd_metric& metric) {
  std::vector<Seed> out(seeds.begin(), seeds.end());
  const std::int64_t one = std::int64_t{1} << metric.shift;  // of a weight
  constexpr int kMostPasses = 64;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::vector<Seed> before = out;
    const LeastPower cells(before, metric);
    bool isChanged = false;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const glm::i64vec3 center = stretched(metric, stepsOf(moved(before[i], centers[i])));
      const std::size_t other = cells.at(center);
      if (before[other].fragment == before[i].fragment) continue;
      isChanged = true;
      if (out[i].shift != centers[i]) {
        out[i].shift = centers[i];
        continue;
      }
      const std::int64_t excess = cells.power(i, center) - cells.power(other, center);
      out[other].weight = std::min(out[other].weight, before[other].weight - excess / one - 1);
    }
    if (!isChanged) return out;
  }
  return std::nullopt;
}

// Of seeds without weights.  A seed that moves may be nearer to the center of another's voxel than
// before, so this is done again until nothing moves.  Drawn seeds take two passes; where many lie
// in a row that each move the next, all move.
std::vector<Seed> settledPoints(std::span<const Seed> seeds, std::span<const glm::ivec3> centers,
                                Metric metric, const sherd_metric& matrix) {
  std::vector<Seed> out(seeds.begin(), seeds.end());
  constexpr int kMostPasses = 8;
  bool isChanged = true;
  for (int pass = 0; isChanged && pass < kMostPasses; ++pass) {
    isChanged = false;
    std::vector<NearestSeed::Site> sites;
    for (const Seed& seed : out)
      sites.push_back({stretched(matrix, stepsOf(seed)), seed.fragment, 0});
    const NearestSeed nearest(std::move(sites), 1, metric);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i].shift == centers[i]) continue;
      const Seed center = moved(out[i], centers[i]);
      if (nearest.fragmentAt(stretched(matrix, stepsOf(center)), 0) == center.fragment) continue;
      out[i] = center;
      isChanged = true;
    }
  }
  for (std::size_t i = 0; isChanged && i < out.size(); ++i) out[i].shift = centers[i];
  return out;
}

bool hasWeights(std::span<const Seed> seeds) {
  return std::any_of(seeds.begin(), seeds.end(), [](const Seed& seed) { return seed.weight != 0; });
}

// Returns nothing where voxels of two fragments' seeds have the same middle.
std::optional<std::vector<Seed>> settledInWalls(std::span<const Seed> seeds,
                                                const sherd_metric& matrix,
                                                const WallMiddles& walls) {
  const std::vector<glm::ivec3> centers = centersOf(seeds, &walls);
  if (hasWeights(seeds)) return settledWeights(seeds, centers, matrix);
  std::vector<Seed> out = settledPoints(seeds, centers, Metric::euclidean, matrix);
  const LeastPower cells(out, matrix);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t own = cells.at(stretched(matrix, stepsOf(moved(out[i], centers[i]))));
    if (out[own].fragment != out[i].fragment) return std::nullopt;
  }
  return out;
}

}  // namespace

std::vector<Seed> settled(std::span<const Seed> seeds, Metric metric, const Anisotropy& anisotropy,
                          std::shared_ptr<const WallMiddles>& walls) {
  const sherd_metric matrix = metricFor(metric, anisotropy);
  if (walls != nullptr) {
    if (auto found = settledInWalls(seeds, matrix, *walls)) return std::move(*found);
    walls = nullptr;
  }
  const std::vector<glm::ivec3> centers = centersOf(seeds, nullptr);
  if (metric != Metric::euclidean || !hasWeights(seeds)) {
    return settledPoints(seeds, centers, metric, matrix);
  }
  if (auto found = settledWeights(seeds, centers, matrix)) return std::move(*found);
  std::vector<Seed> plain(seeds.begin(), seeds.end());
  for (Seed& seed : plain) {
    seed.shift = glm::ivec3(0);
    seed.weight = 0;
  }
  return plain;
}

}  // namespace sherd
