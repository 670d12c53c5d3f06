// Growth of fragments with given shares, by weights of their seeds.
#include "grow/sized/sized_growth.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "base/random.h"
#include "grow/fields/metric.h"
#include "grow/fields/settle.h"
#include "grow/sized/crack_areas.h"
#include "grow/sized/split_plan.h"
#include "seed/draw/candidates.h"
#include "seed/draw/samplers.h"
#include "seed/draw/sizes.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

constexpr int kMostGrowths = 100;
constexpr int kMostInVain = 25;          // growths without a lower error, when weights are refined
constexpr int kMostApproach = 60;        // growths before that
constexpr double kTolerance = 0.02;      // of a share
constexpr double kVoxelTolerance = 8.0;  // for shares of few voxels
constexpr int kBetweenNudges = 4;        // growths
constexpr double kFewMisplaced = 0.015;  // share of the solid from which Newton's method works
constexpr double kGain = 1.5;

// Shares that are drawn and met.
struct Targets {
  std::vector<double> drawn;   // [fragments + 1] shares
  std::vector<double> voxels;  // [fragments + 1] of fragments that fill their component
};

// Gives each component those of the drawn shares, the largest first, that fill it, and each
// fragment the share of its rank among those of its component.
Targets targetsFor(const std::vector<double>& drawn, const std::vector<std::uint64_t>& counts,
                   const std::vector<std::uint32_t>& componentOf, const VoxelComponents& solid) {
  const std::size_t fragments = counts.size() - 1;
  std::vector<std::vector<std::size_t>> of(solid.count());  // fragments, the largest first
  for (std::size_t id = 1; id <= fragments; ++id) of[componentOf[id]].push_back(id);
  const std::vector<double> mass(solid.voxels().begin(), solid.voxels().end());
  std::vector<std::uint64_t> most;
  for (const std::vector<std::size_t>& own : of) most.push_back(own.size());
  std::vector<std::vector<double>> shares = sharesOfComponents(drawn, mass, most);
  for (std::vector<double>& own : shares) std::sort(own.begin(), own.end(), std::greater<>());
  Targets targets{std::vector<double>(fragments + 1, 0.0), std::vector<double>(fragments + 1, 0.0)};
  for (std::size_t c = 0; c < of.size(); ++c) {
    std::stable_sort(of[c].begin(), of[c].end(),
                     [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
    const double sum = std::accumulate(shares[c].begin(), shares[c].end(), 0.0);
    for (std::size_t i = 0; i < of[c].size(); ++i) {
      targets.drawn[of[c][i]] = shares[c][i];
      targets.voxels[of[c][i]] = shares[c][i] / sum * static_cast<double>(solid.voxels()[c]);
    }
  }
  return targets;
}

double toleratedAt(double voxels) { return std::max(kTolerance * voxels, kVoxelTolerance); }

bool isMet(std::uint64_t count, double voxels) {
  return std::abs(static_cast<double>(count) - voxels) <= toleratedAt(voxels);
}

// The greatest error of a fragment's voxels, by what is tolerated: 1 or less if all shares are met.
double errorOf(const std::vector<std::uint64_t>& counts, const Targets& targets) {
  double worst = 0.0;
  for (std::size_t id = 1; id < counts.size(); ++id) {
    const double off = std::abs(static_cast<double>(counts[id]) - targets.voxels[id]);
    worst = std::max(worst, off / toleratedAt(targets.voxels[id]));
  }
  return worst;
}

// The share of the solid that belongs to another fragment than it should.
double misplacedShare(const std::vector<std::uint64_t>& counts, const Targets& targets) {
  double misplaced = 0.0, all = 0.0;
  for (std::size_t id = 1; id < counts.size(); ++id) {
    misplaced += 0.5 * std::abs(static_cast<double>(counts[id]) - targets.voxels[id]);
    all += static_cast<double>(counts[id]);
  }
  return misplaced / all;
}

double sizeErrorOf(const std::vector<std::uint64_t>& counts, const Targets& targets) {
  const double all =
      static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
  double worst = 0.0;
  for (std::size_t id = 1; id < counts.size(); ++id) {
    const double share = static_cast<double>(counts[id]) / all;
    worst = std::max(worst, std::abs(share / targets.drawn[id] - 1.0));
  }
  return worst;
}

// Grows from seeds whose weights and points are improved step by step.
class Sizing {
 public:
  Sizing(std::vector<Seed> seeds, const SharedGrowthOptions& options,
         std::vector<std::uint32_t> componentOf)
      : metric_(metricFor(Metric::euclidean, options.grow.anisotropy)),
        anisotropy_(options.grow.anisotropy),
        walls_(options.grow.walls.empty() ? nullptr : options.grow.walls.front()),
        componentOf_(std::move(componentOf)),
        seeds_(std::move(seeds)),
        seed_(options.seed),
        weight_(componentOf_.size(), 0.0) {
    seedsOf_.resize(componentOf_.size());
    settle();
  }

  const std::vector<Seed>& seeds() const { return seeds_; }

  // Changes weights towards the targets, and moves seeds that cracks come near.  As long as many
  // voxels are misplaced, a weight grows by the squared radius that its fragment lacks, as if that
  // were a ball: Newton's method, which `refines` means, overshoots then.
  //   nudges  0, or the number of their draws
  void improve(const Labels& cells, const std::vector<std::uint64_t>& counts,
               const Targets& targets, bool refines, std::uint64_t nudges) {
    for (std::vector<std::size_t>& of : seedsOf_) of.clear();
    for (std::size_t i = 0; i < seeds_.size(); ++i) seedsOf_[seeds_[i].fragment].push_back(i);
    std::vector<WeightSpring> springs;
    std::vector<double> squaredGaps;
    for (const CrackArea& crack : crackAreas(cells)) {
      const Gap gap = gapOf(crack.a, crack.b);
      springs.push_back({crack.a, crack.b, crack.faces / std::max(gap.gradient, 1e-3)});
      squaredGaps.push_back(gap.squared);
    }
    if (!refines) {
      for (std::size_t id = 1; id < weight_.size(); ++id) {
        weight_[id] += kGain * (squaredRadius(targets.voxels[id]) -
                                squaredRadius(static_cast<double>(counts[id])));
      }
    } else {
      const std::vector<double> change = weightsFor(springs, changes(counts, targets));
      for (std::size_t id = 1; id < weight_.size(); ++id) weight_[id] += change[id];
    }
    moveNear(cells, springs, squaredGaps, targets, refines);
    if (nudges != 0) nudge(cells, counts, targets, nudges);
    settle();
  }

 private:
  // Of a ball of so many voxels.
  static double radiusOf(double voxels) { return std::cbrt(0.75 * voxels / std::numbers::pi); }
  static double squaredRadius(double voxels) { return radiusOf(voxels) * radiusOf(voxels); }

  // Moves seeds to their fragment's center that a crack is near: by the size that it is to have.
  //   squaredGaps  [cracks] between the nearest seeds of both fragments, by the metric
  void moveNear(const Labels& cells, const std::vector<WeightSpring>& cracks,
                const std::vector<double>& squaredGaps, const Targets& targets, bool refines) {
    const double near = refines ? 0.3 : 0.5;  // of the fragment's radius
    std::vector<bool> moves(weight_.size(), false);
    for (std::size_t i = 0; i < cracks.size(); ++i) {
      const WeightSpring& crack = cracks[i];
      const double squared = std::max(squaredGaps[i], 1e-6);
      const double apart = std::sqrt(squared), lead = weight_[crack.a] - weight_[crack.b];
      const double fromA = 0.5 * (squared + lead) / apart, fromB = 0.5 * (squared - lead) / apart;
      if (fromA < near * radiusOf(targets.voxels[crack.a])) moves[crack.a] = true;
      if (fromB < near * radiusOf(targets.voxels[crack.b])) moves[crack.b] = true;
    }
    if (std::find(moves.begin(), moves.end(), true) == moves.end()) return;
    const std::vector<Seed> centered = centeredSeeds(cells, seeds_);
    for (std::size_t i = 0; i + 1 < weight_.size(); ++i) {
      if (moves[seeds_[i].fragment]) seeds_[i] = centered[i];
    }
  }

  // Moves the seeds of fragments that are not met by up to 1.5 voxels: where a crack is parallel to
  // layers of voxels, a whole layer changes sides at once, until the crack is tilted.
  void nudge(const Labels& cells, const std::vector<std::uint64_t>& counts, const Targets& targets,
             std::uint64_t growth) {
    for (std::size_t i = 0; i + 1 < weight_.size(); ++i) {
      Seed& seed = seeds_[i];
      if (isMet(counts[seed.fragment], targets.voxels[seed.fragment])) continue;
      const glm::dvec3 unit =
          randomPoint(seed_, Stage::sizeNudge, drawItem(seed.fragment, growth)) - 0.5;
      const glm::dvec3 point = pointOf(seed) + 3.0 * unit;
      const openvdb::Coord voxel = nearestVoxel(point);
      const std::uint32_t leaf = findLeaf(*cells.blocks, voxel);
      if (leaf == LeafBlocks::kNone) continue;
      if (cells.fragment[std::size_t{leaf} * 512 + offsetFromCoord(voxel)] != seed.fragment) {
        continue;
      }
      seed.voxel = voxel;
      seed.shift = shiftOf(point, voxel);
    }
  }

  struct Gap {
    double gradient;  // of the difference of squared distances, sum of its absolute components
    double squared;   // distance of the seeds, by the metric
  };

  // Between the seeds of two fragments that are nearest to each other.
  Gap gapOf(std::uint16_t a, std::uint16_t b) const {
    Gap nearest{0.0, std::numeric_limits<double>::infinity()};
    const double step = kSeedSteps, unit = std::ldexp(step * step, metric_.shift);
    for (const std::size_t i : seedsOf_[a]) {
      for (const std::size_t j : seedsOf_[b]) {
        const glm::i64vec3 d = stretched(metric_, stepsOf(seeds_[i]) - stepsOf(seeds_[j]));
        const double squared = static_cast<double>(d.x * d.x + d.y * d.y + d.z * d.z) / unit;
        if (squared >= nearest.squared) continue;
        nearest.squared = squared;
        nearest.gradient = 0.0;
        for (int column = 0; column < 3; ++column) {
          std::int64_t g = 0;
          for (int row = 0; row < 3; ++row) g += metric_.row[3 * row + column] * d[row];
          nearest.gradient += 2.0 * std::abs(static_cast<double>(g)) / (unit / step);
        }
      }
    }
    return nearest;
  }

  // Voxels to gain.  A step at most halves or doubles a fragment, because the change by weights is
  // linear for small ones only.
  std::vector<double> changes(const std::vector<std::uint64_t>& counts,
                              const Targets& targets) const {
    std::vector<double> change(counts.size(), 0.0);
    std::vector<double> sum, voxels;
    for (std::size_t id = 1; id < counts.size(); ++id) {
      const auto own = static_cast<double>(counts[id]);
      change[id] = std::clamp(targets.voxels[id] - own, -0.5 * own, own);
      sum.resize(std::max<std::size_t>(sum.size(), componentOf_[id] + 1u), 0.0);
      voxels.resize(sum.size(), 0.0);
      sum[componentOf_[id]] += change[id];
      voxels[componentOf_[id]] += own;
    }
    for (std::size_t id = 1; id < counts.size(); ++id) {
      const std::uint32_t c = componentOf_[id];
      change[id] -= sum[c] * static_cast<double>(counts[id]) / voxels[c];
    }
    return change;
  }

  void settle() {
    constexpr double kUnit = kSeedSteps * kSeedSteps;
    constexpr double kMost = 1e8;  // voxels squared
    for (Seed& seed : seeds_) {
      seed.weight = std::llround(kUnit * std::clamp(weight_[seed.fragment], -kMost, kMost));
    }
    std::shared_ptr<const WallMiddles> walls = walls_;
    std::vector<Seed> own = settled(seeds_, Metric::euclidean, anisotropy_, walls);
    if (walls != nullptr) {  // points stay in their voxels: growth moves them by itself
      for (std::size_t i = 0; i < own.size(); ++i) seeds_[i].weight = own[i].weight;
    } else {
      seeds_ = std::move(own);
    }
    for (const Seed& seed : seeds_) {
      weight_[seed.fragment] =
          std::min(weight_[seed.fragment], static_cast<double>(seed.weight) / kUnit);
    }
  }

  sherd_metric metric_;
  Anisotropy anisotropy_;
  std::shared_ptr<const WallMiddles> walls_;
  std::vector<std::uint32_t> componentOf_;  // [fragments + 1]
  std::vector<Seed> seeds_;
  std::uint64_t seed_;
  std::vector<double> weight_;                     // [fragments + 1] voxels squared
  std::vector<std::vector<std::size_t>> seedsOf_;  // [fragments + 1]
};

std::vector<std::uint32_t> componentsOf(const std::vector<Seed>& seeds, const LeafBlocks& blocks,
                                        const VoxelComponents& components) {
  std::vector<std::uint32_t> of(static_cast<std::size_t>(fragmentsOf(seeds)) + 1, 0);
  for (const Seed& seed : seeds) {
    of[seed.fragment] = components.at(std::size_t{findLeaf(blocks, seed.voxel)} * 512 +
                                      offsetFromCoord(seed.voxel));
  }
  return of;
}

Error belowLeast() {
  return Error(ErrorCode::usage,
               "no fragments of the drawn sizes were found of which each has the least share; try "
               "fewer pieces, or a lower least share",
               OptionNames{"pieces", "min-share"});
}

}  // namespace

SeededLabels grownToSizes(const Solid& solid, const VoxelComponents& components,
                          std::vector<Seed> seeds, Device& device,
                          const SharedGrowthOptions& options, const Progress* progress) {
  const ShareOptions& shares = options.shares;
  const auto fragments = static_cast<std::size_t>(fragmentsOf(seeds));
  const std::uint64_t voxels = solid.blocks->insideVoxels();
  const std::uint64_t least = leastVoxels(shares, voxels);
  GrowOptions quick = options.grow;
  quick.outerSteps = 0;
  quick.keepCost = false;
  const auto growFrom = [&](const std::vector<Seed>& from, const GrowOptions& grow) {
    return std::move(
        sherd::grow(solid.blocks, std::span(&from, 1), device, grow, progress).front());
  };
  const std::vector<std::uint32_t> componentOf = componentsOf(seeds, *solid.blocks, components);
  Sizing sizing(std::move(seeds), options, componentOf);
  // Rough cracks lie beside the cells' planes: the voxels are counted with them, but what weights
  // and moves change is known of the cells.
  GrowOptions smooth = quick;
  smooth.roughness = 0.0;
  const bool isRough = !quick.roughness.isZero();
  const auto countIn = [&](const Labels& cells) {
    return countVoxels(isRough ? growFrom(sizing.seeds(), quick) : cells);
  };
  Labels cells = growFrom(sizing.seeds(), smooth);
  std::vector<std::uint64_t> counts = countIn(cells);
  const Targets targets = targetsFor(
      drawnShares(shares.sizes, shares.sizeParameter, fragments,
                  leastShareOf(shares, 1.0 + 2.0 * kTolerance, fragments, voxels), options.seed),
      counts, componentOf, components);
  SeededLabels best;
  double leastError = std::numeric_limits<double>::infinity();
  bool refines = false;
  for (int growths = 1, lastChange = 0;; ++growths) {
    const bool isEnough = *std::min_element(counts.begin() + 1, counts.end()) >= least;
    const double error = errorOf(counts, targets);
    if (isEnough && error < leastError) {
      leastError = error;
      lastChange = growths;
      best.seeds = sizing.seeds();
      best.sizeError = sizeErrorOf(counts, targets);
    }
    refines = refines || misplacedShare(counts, targets) < kFewMisplaced || growths > kMostApproach;
    if (!refines) lastChange = growths;
    const bool isInVain = !best.seeds.empty() && growths - lastChange >= kMostInVain;
    if (leastError <= 1.0 || growths == kMostGrowths || isInVain) break;
    const bool isStuck = (growths - lastChange) % kBetweenNudges == kBetweenNudges - 1;
    sizing.improve(cells, counts, targets, refines,
                   refines && isStuck ? static_cast<std::uint64_t>(growths) : 0);
    cells = growFrom(sizing.seeds(), smooth);
    counts = countIn(cells);
  }
  if (best.seeds.empty()) throw belowLeast();
  best.labels = growFrom(best.seeds, options.grow);
  return best;
}

}  // namespace sherd
