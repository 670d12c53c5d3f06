// Erosion: fragments wear independently of each other, because what is not a fragment's own is
// either solid or not, whoever's it is and however worn.
#include <sherd/erode.h>
#include <sherd/error.h>
#include <sherd/seeds.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/random.h"
#include "erode/masks.h"
#include "erode/shape.h"
#include "erode/shell.h"
#include "grow/parts.h"

namespace sherd {
namespace {

constexpr int kMostIterations = 1000;
constexpr std::int64_t kMillion = 1'000'000;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::usage, "erode: " + what);
}

// Also false for a number that is none.
bool isShare(double x) { return x > 0 && x <= 1; }

void check(const LeafBlocks& blocks, const Labels& labels, int fragments,
           const ErodeOptions& options) {
  if (options.size < 3 || options.size > 2 * kLargestReach + 1 || options.size % 2 == 0) {
    refuse("a size of " + std::to_string(options.size) +
           " was asked for, odd sizes from 3 to 13 are possible");
  }
  if (options.iterations < 0 || options.iterations > kMostIterations) {
    refuse(std::to_string(options.iterations) + " iterations were asked for, 0 to " +
           std::to_string(kMostIterations) + " are possible");
  }
  if (!isShare(options.threshold)) {
    refuse("the threshold is " + std::to_string(options.threshold) +
           ", it must be above 0 and at most 1");
  }
  if (!isShare(options.probability)) {
    refuse("the probability is " + std::to_string(options.probability) +
           ", it must be above 0 and at most 1");
  }
  if (fragments < 1 || fragments > kMaxFragments) {
    refuse("there are " + std::to_string(fragments) + " fragments, 1 to " +
           std::to_string(kMaxFragments) + " are possible");
  }
  if (labels.fragment.size() != blocks.count() * 512) {
    refuse("there are " + std::to_string(labels.fragment.size()) + " labels for " +
           std::to_string(blocks.count()) + " leaves of 512 voxels");
  }
}

// The options as integers, so that no test of a voxel rounds.
struct Rule {
  std::vector<Shape> shapes;
  std::vector<int> allowed;  // of each shape: a voxel is worn when more cells than this are empty
  int reach = 1;             // voxels
  std::uint64_t chance = 0;  // out of 2^53 draws, how many test a voxel
  std::uint64_t seed = 0;
};

Rule ruleOf(const ErodeOptions& options) {
  Rule rule;
  rule.reach = options.size / 2;
  rule.shapes = shapesOf(options.shape, rule.reach, options.planes);
  const std::int64_t millionths = std::max(std::llround(options.threshold * 1e6), 1LL);
  for (const Shape& shape : rule.shapes) {
    const std::int64_t needed = (millionths * shape.cells + kMillion - 1) / kMillion;
    rule.allowed.push_back(shape.cells - static_cast<int>(needed));
  }
  rule.chance = static_cast<std::uint64_t>(std::ceil(std::ldexp(options.probability, 53)));
  rule.seed = options.seed;
  return rule;
}

// A voxel's place in the grid and nothing else decides, so that threads, leaves and other fragments
// cannot.
bool isDrawn(const Rule& rule, int iteration, const openvdb::Coord& voxel) {
  const auto bits = [](int i) { return std::uint64_t{static_cast<std::uint32_t>(i)}; };
  const std::uint64_t item = mixed((bits(iteration) << 32 | bits(voxel.x())) + 1) +
                             (bits(voxel.y()) << 32 | bits(voxel.z()));
  return randomBits(rule.seed, Stage::erosion, item) >> 11 < rule.chance;
}

// The filled voxels in and round a leaf, a row along z for each x and y:
//
//     bit   0 ...... 7  8 ..... 15  16 .... 23
//     z    -8 ..... -1  0 ...... 7   8 ..... 15
class Halo {
 public:
  Halo(const std::array<LeafMask, 27>& filled, int reach) {
    for (int x = -reach; x < 8 + reach; ++x) {
      for (int y = -reach; y < 8 + reach; ++y) {
        const auto first = static_cast<std::size_t>(((x >> 3) + 1) * 9 + ((y >> 3) + 1) * 3);
        const auto byte = [&](std::size_t k) {
          const std::uint64_t word = filled[first + k][static_cast<std::size_t>(x & 7)];
          return static_cast<std::uint32_t>((word >> (8 * (y & 7))) & 0xff);
        };
        rows_[place(x, y)] = byte(0) | byte(1) << 8 | byte(2) << 16;
      }
    }
  }

  std::uint32_t row(int x, int y) const { return rows_[place(x, y)]; }

  // The z of row (x, y) where one of the 27 cells round is empty, bit 0 for z = 0.
  std::uint32_t touching(int x, int y) const {
    std::uint32_t full = ~0u;
    for (int i = x - 1; i <= x + 1; ++i) {
      for (int j = y - 1; j <= y + 1; ++j) full &= row(i, j);
    }
    return (~(full & full << 1 & full >> 1) >> 8) & 0xff;
  }

  bool misses(const Shape& shape, int allowed, int x, int y, int z) const {
    for (const ShapeRow& cells : shape.rows) {
      const std::uint32_t empty = ~row(x + cells.x, y + cells.y) >> (8 + z - cells.halfLength);
      allowed -= std::popcount(empty & ((2u << (2 * cells.halfLength)) - 1));
      if (allowed < 0) return true;
    }
    return false;
  }

 private:
  static constexpr int kSide = 8 + 2 * kLargestReach;
  static std::size_t place(int x, int y) {
    return static_cast<std::size_t>((x + kLargestReach) * kSide + y + kLargestReach);
  }

  std::array<std::uint32_t, std::size_t{kSide} * kSide> rows_;
};

// Wears the fragments of one solid.
class Wear {
 public:
  Wear(const LeafBlocks& blocks, const ErodeOptions& options)
      : blocks_(blocks), rule_(ruleOf(options)) {
    if (options.on == ErodeOn::fracture) round_ = leavesRound(blocks.origins);
  }

  // The voxels that an iteration takes: [n] masks.
  std::vector<LeafMask> takenFrom(const FragmentMasks& fragment, int iteration) const {
    std::vector<LeafMask> taken = shellOf(fragment);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, taken.size(), 16), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        if (isEmpty(taken[i])) continue;
        taken[i] = takenFromLeaf(fragment, i, taken[i], iteration);
      }
    });
    return taken;
  }

 private:
  LeafMask takenFromLeaf(const FragmentMasks& fragment, std::size_t i, const LeafMask& shell,
                         int iteration) const {
    const Halo halo(filledRound(fragment, i), rule_.reach);
    LeafMask taken{};
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        const std::uint64_t row = shell[static_cast<std::size_t>(x)] >> (8 * y);
        for (std::uint32_t zs = static_cast<std::uint32_t>(row & 0xff) & halo.touching(x, y); zs;
             zs &= zs - 1) {
          const int z = std::countr_zero(zs);
          if (!isDrawn(rule_, iteration, fragment.origins[i] + openvdb::Coord(x, y, z))) continue;
          if (isWorn(halo, x, y, z)) {
            taken[static_cast<std::size_t>(x)] |= std::uint64_t{1} << (8 * y + z);
          }
        }
      }
    }
    return taken;
  }

  bool isWorn(const Halo& halo, int x, int y, int z) const {
    for (std::size_t k = 0; k < rule_.shapes.size(); ++k) {
      if (halo.misses(rule_.shapes[k], rule_.allowed[k], x, y, z)) return true;
    }
    return false;
  }

  std::array<LeafMask, 27> filledRound(const FragmentMasks& fragment, std::size_t i) const {
    std::array<LeafMask, 27> filled{};
    for (std::size_t k = 0; k < 27; ++k) {
      const std::uint32_t own = fragment.round[i][k];
      if (own != LeafBlocks::kNone) filled[k] = fragment.masks[own];
      if (round_.empty()) continue;
      const std::uint32_t leaf = round_[fragment.leaf[i]][k];
      for (std::size_t x = 0; x < 8; ++x) {
        filled[k][x] |= leaf == LeafBlocks::kNone ? ~std::uint64_t{0}
                                                  : ~blocks_.inside[std::size_t{leaf} * 8 + x];
      }
    }
    return filled;
  }

  const LeafBlocks& blocks_;
  Rule rule_;
  std::vector<LeafRound> round_;  // of the solid's leaves; empty where outside it is not filled
};

bool takesAll(const FragmentMasks& fragment, const std::vector<LeafMask>& taken) {
  return taken == fragment.masks;
}

// Make `taken` worn; how many voxels that is.
std::uint64_t take(FragmentMasks& fragment, const std::vector<LeafMask>& taken, Labels& labels) {
  std::uint64_t voxels = 0;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    for (std::size_t x = 0; x < 8; ++x) {
      fragment.masks[i][x] &= ~taken[i][x];
      for (std::uint64_t bits = taken[i][x]; bits; bits &= bits - 1, ++voxels) {
        const auto z = static_cast<std::size_t>(std::countr_zero(bits));
        labels.fragment[std::size_t{fragment.leaf[i]} * 512 + x * 64 + z] = Labels::kWorn;
      }
    }
  }
  return voxels;
}

// A fragment's voxels that are not in the masks [leaf*8] of the blocks.
std::vector<LeafMask> without(const FragmentMasks& fragment, std::span<const std::uint64_t> kept) {
  std::vector<LeafMask> rest = fragment.masks;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t x = 0; x < 8; ++x) rest[i][x] &= ~kept[std::size_t{fragment.leaf[i]} * 8 + x];
  }
  return rest;
}

}  // namespace

Erosion erode(const LeafBlocks& blocks, const Labels& labels, int fragments,
              const ErodeOptions& options, Device& device, const Progress* progress) {
  check(blocks, labels, fragments, options);
  step(progress, "erode", 0.0);
  Erosion result{labels, std::vector<std::uint64_t>(static_cast<std::size_t>(fragments) + 1)};
  if (options.iterations == 0) return result;

  std::vector<FragmentMasks> masks = fragmentMasks(blocks, labels, fragments);
  // Fragments share leaves but no voxels, so each writes to places of its own.
  const auto forEachFragment = [&](const auto& takenFrom) {
    tbb::parallel_for(std::size_t{0}, masks.size(), [&](std::size_t i) {
      const std::vector<LeafMask> taken = takenFrom(masks[i]);
      if (!takesAll(masks[i], taken)) result.worn[i + 1] += take(masks[i], taken, result.labels);
    });
  };
  const Wear wear(blocks, options);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    forEachFragment(
        [&](const FragmentMasks& fragment) { return wear.takenFrom(fragment, iteration); });
    step(progress, "erode", static_cast<double>(iteration + 1) / options.iterations);
  }
  if (options.crumbs == Crumbs::worn) {
    const std::vector<std::uint64_t> largest = largestParts(blocks, result.labels, device);
    forEachFragment([&](const FragmentMasks& fragment) { return without(fragment, largest); });
  }
  for (std::size_t i = 1; i < result.worn.size(); ++i) result.worn[0] += result.worn[i];
  return result;
}

}  // namespace sherd
