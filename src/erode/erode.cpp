// Erosion.  Fragments erode independently of each other: a voxel outside a fragment counts as
// filled or empty regardless of the other fragments and their erosion.
#include <sherd/error.h>
#include <sherd/labels.h>
#include <sherd/seeds.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/random.h"
#include "erode/largest_part.h"
#include "erode/masks.h"
#include "erode/passes.h"
#include "erode/shape.h"
#include "erode/shell.h"
#include "grow/fields/check_labels.h"
#include "grow/fields/solid_components.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

constexpr std::int64_t kMillion = 1'000'000;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::usage, "erode: " + what);
}

// False for NaN.
bool isShare(double x) { return x > 0 && x <= 1; }

void check(const Labels& labels, const ErodeOptions& options) {
  if (options.least < 1) refuse("a fragment keeps at least one voxel");
  if (!isShare(options.threshold)) {
    refuse("the threshold is " + std::to_string(options.threshold) +
           "; it must be above 0 and at most 1");
  }
  if (!isShare(options.probability)) {
    refuse("the probability is " + std::to_string(options.probability) +
           "; it must be above 0 and at most 1");
  }
  if (labels.fragmentCount < 1 || labels.fragmentCount > kMaxFragments) {
    refuse("the number of fragments is " + std::to_string(labels.fragmentCount) +
           "; expected 1 to " + std::to_string(kMaxFragments));
  }
  checkLabels(labels);
}

// The options as integers, so that the test of a voxel is exact.
struct Rule {
  std::vector<Shape> shapes;
  std::vector<int> allowed;  // [shapes] a voxel is eroded when more cells than this are empty
  int reach = 1;             // voxels
  std::uint64_t chance = 0;  // probability that a voxel is tested, times 2^53
  std::uint64_t seed = 0;
};

Rule ruleOf(const ErodeOptions& options, const ErosionPasses& passes) {
  Rule rule;
  rule.reach = passes.size / 2;
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

// Depends only on seed, iteration and voxel coordinates, not on threads, leaves or other fragments.
bool isDrawn(const Rule& rule, int iteration, const openvdb::Coord& voxel) {
  const auto bits = [](int i) { return std::uint64_t{static_cast<std::uint32_t>(i)}; };
  const std::uint64_t item = mixed((bits(iteration) << 32 | bits(voxel.x())) + 1) +
                             (bits(voxel.y()) << 32 | bits(voxel.z()));
  return randomBits(rule.seed, Stage::erosion, item) >> 11 < rule.chance;
}

// The filled voxels in and around a leaf, a row along z for each x and y:
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
        rows_[indexOf(x, y)] = byte(0) | byte(1) << 8 | byte(2) << 16;
      }
    }
  }

  std::uint32_t row(int x, int y) const { return rows_[indexOf(x, y)]; }

  // Returns the z of row (x, y) where one of the 27 neighboring cells is empty, bit 0 for z = 0.
  std::uint32_t nearEmpty(int x, int y) const {
    std::uint32_t full = ~0u;
    for (int i = x - 1; i <= x + 1; ++i) {
      for (int j = y - 1; j <= y + 1; ++j) full &= row(i, j);
    }
    return (~(full & full << 1 & full >> 1) >> 8) & 0xff;
  }

  // Whether more than `allowed` cells of a shape are empty.
  bool isErodedBy(const Shape& shape, int allowed, int x, int y, int z) const {
    for (const ShapeRow& cells : shape.rows) {
      const std::uint32_t empty = ~row(x + cells.x, y + cells.y) >> (8 + z - cells.halfLength);
      allowed -= std::popcount(empty & ((2u << (2 * cells.halfLength)) - 1));
      if (allowed < 0) return true;
    }
    return false;
  }

 private:
  static constexpr int kSide = 8 + 2 * kLargestReach;
  static std::size_t indexOf(int x, int y) {
    return static_cast<std::size_t>((x + kLargestReach) * kSide + y + kLargestReach);
  }

  std::array<std::uint32_t, std::size_t{kSide} * kSide> rows_;
};

// Erodes the fragments of one solid.
class Eroder {
 public:
  Eroder(const LeafBlocks& blocks, const ErodeOptions& options, const ErosionPasses& passes)
      : blocks_(blocks),
        rule_(ruleOf(options, passes)),
        testsCracks_(options.on != ErodeOn::all),
        fillsOutside_(options.on == ErodeOn::fracture) {
    if (testsCracks_) solidNeighbors_ = leafNeighbors(blocks.origins);
  }

  // Returns the voxels that an iteration erodes: [n] masks.
  std::vector<LeafMask> erodedIn(const FragmentMasks& fragment, int iteration) const {
    std::vector<LeafMask> eroded = shellOf(fragment);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, eroded.size(), 16),
                      [&](const auto& range) {
                        for (std::size_t i = range.begin(); i < range.end(); ++i) {
                          if (isEmpty(eroded[i])) continue;
                          eroded[i] = erodedInLeaf(fragment, i, eroded[i], iteration);
                        }
                      });
    return eroded;
  }

 private:
  LeafMask erodedInLeaf(const FragmentMasks& fragment, std::size_t i, const LeafMask& shell,
                        int iteration) const {
    const std::array<LeafMask, 27> filled = filledAround(fragment, i);
    const Halo near(testsCracks_ ? withOutside(filled, fragment, i) : filled, rule_.reach);
    std::optional<Halo> own;
    if (testsCracks_ && !fillsOutside_) own.emplace(filled, rule_.reach);
    const Halo& counted = own ? *own : near;
    LeafMask eroded{};
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        const std::uint64_t row = shell[static_cast<std::size_t>(x)] >> (8 * y);
        for (std::uint32_t zs = static_cast<std::uint32_t>(row & 0xff) & near.nearEmpty(x, y); zs;
             zs &= zs - 1) {
          const int z = std::countr_zero(zs);
          if (!isDrawn(rule_, iteration, fragment.origins[i] + openvdb::Coord(x, y, z))) continue;
          if (isEroded(counted, x, y, z)) {
            eroded[static_cast<std::size_t>(x)] |= std::uint64_t{1} << (8 * y + z);
          }
        }
      }
    }
    return eroded;
  }

  bool isEroded(const Halo& halo, int x, int y, int z) const {
    for (std::size_t k = 0; k < rule_.shapes.size(); ++k) {
      if (halo.isErodedBy(rule_.shapes[k], rule_.allowed[k], x, y, z)) return true;
    }
    return false;
  }

  static std::array<LeafMask, 27> filledAround(const FragmentMasks& fragment, std::size_t i) {
    std::array<LeafMask, 27> filled{};
    for (std::size_t k = 0; k < 27; ++k) {
      const std::uint32_t neighbor = fragment.neighbors[i][k];
      if (neighbor != LeafBlocks::kNone) filled[k] = fragment.masks[neighbor];
    }
    return filled;
  }

  // Fills what is outside the solid.
  std::array<LeafMask, 27> withOutside(std::array<LeafMask, 27> filled,
                                       const FragmentMasks& fragment, std::size_t i) const {
    for (std::size_t k = 0; k < 27; ++k) {
      const std::uint32_t leaf = solidNeighbors_[fragment.leaf[i]][k];
      for (std::size_t x = 0; x < 8; ++x) {
        filled[k][x] |= leaf == LeafBlocks::kNone
                            ? ~std::uint64_t{0}
                            : ~insideOfLayer(blocks_, fragment.layer, std::size_t{leaf} * 8 + x);
      }
    }
    return filled;
  }

  const LeafBlocks& blocks_;
  Rule rule_;
  bool testsCracks_ = false;                   // only voxels near a crack are tested
  bool fillsOutside_ = false;                  // cells outside the solid are filled
  std::vector<LeafNeighbors> solidNeighbors_;  // of the solid's leaves, if cracks are tested
};

// Labels voxels of a fragment as eroded; returns their number.
std::uint64_t markEroded(FragmentMasks& fragment, const std::vector<LeafMask>& eroded,
                         Labels& labels) {
  std::uint64_t voxels = 0;
  for (std::size_t i = 0; i < eroded.size(); ++i) {
    for (std::size_t x = 0; x < 8; ++x) {
      fragment.masks[i][x] &= ~eroded[i][x];
      for (std::uint64_t bits = eroded[i][x]; bits; bits &= bits - 1, ++voxels) {
        const auto z = static_cast<std::size_t>(std::countr_zero(bits));
        labels.fragment[std::size_t{fragment.leaf[i]} * 512 + x * 64 + z] = Labels::kEroded;
      }
    }
  }
  return voxels;
}

// Returns a fragment's voxels that are not in the masks [leaf*8] of the blocks.
std::vector<LeafMask> without(const FragmentMasks& fragment, std::span<const std::uint64_t> kept) {
  std::vector<LeafMask> rest = fragment.masks;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t x = 0; x < 8; ++x) rest[i][x] &= ~kept[std::size_t{fragment.leaf[i]} * 8 + x];
  }
  return rest;
}

bool areEmpty(const std::vector<LeafMask>& masks) {
  return std::all_of(masks.begin(), masks.end(), [](const LeafMask& m) { return isEmpty(m); });
}

// Whether a fragment may lose voxels of its own.
bool leavesEnough(const FragmentMasks& fragment, const std::vector<LeafMask>& eroded,
                  std::uint64_t least) {
  if (least <= 1) return eroded != fragment.masks;
  return voxelsOf(fragment.masks) >= least + voxelsOf(eroded);
}

// Gives a fragment the voxels that it lost.
void restore(const FragmentMasks& fragment, std::uint16_t id, const Labels& before,
             Labels& labels) {
  for (const std::uint32_t leaf : fragment.leaf) {
    for (std::size_t voxel = std::size_t{leaf} * 512; voxel < std::size_t{leaf} * 512 + 512;
         ++voxel) {
      if (before.fragment[voxel] == id) labels.fragment[voxel] = id;
    }
  }
}

std::vector<LeafMask> difference(std::vector<LeafMask> masks, const std::vector<LeafMask>& other) {
  for (std::size_t i = 0; i < masks.size(); ++i) {
    for (std::size_t x = 0; x < 8; ++x) masks[i][x] &= ~other[i][x];
  }
  return masks;
}

// Erodes a fragment of which the largest part must keep some voxels after each iteration.  Returns
// the number of voxels lost, islands included.
std::uint64_t erodeConnected(FragmentMasks& fragment, const Eroder& eroder,
                             const ErosionPasses& passes, std::uint64_t least, Labels& labels) {
  std::uint64_t lost = 0;
  for (int iteration = 0; iteration < passes.count; ++iteration) {
    const std::vector<LeafMask> eroded = eroder.erodedIn(fragment, iteration);
    FragmentMasks left = fragment;
    left.masks = difference(std::move(left.masks), eroded);
    if (largestPart(left).voxels >= least) lost += markEroded(fragment, eroded, labels);
  }
  const std::vector<LeafMask> islands = difference(fragment.masks, largestPart(fragment).masks);
  return lost + markEroded(fragment, islands, labels);
}

}  // namespace

Erosion erode(const Labels& labels, const ErodeOptions& options, Device& device,
              const Progress* progress) {
  check(labels, options);
  reportProgress(progress, "erode", 0.0);
  Erosion result{labels,
                 std::vector<std::uint64_t>(static_cast<std::size_t>(labels.fragmentCount) + 1)};
  const ErosionPasses passes =
      passesOf(options, longestSideOr(options.longestSideVoxels, *labels.blocks));
  if (passes.count == 0) return result;

  std::vector<FragmentMasks> masks = fragmentMasks(labels);
  const std::vector<FragmentMasks> whole = options.least > 1 ? masks : std::vector<FragmentMasks>();
  // Fragments share leaves but no voxels, so they write disjoint labels.
  const auto erodeEach = [&](const auto& erodedOf) {
    tbb::parallel_for(std::size_t{0}, masks.size(), [&](std::size_t i) {
      const std::vector<LeafMask> eroded = erodedOf(masks[i]);
      if (leavesEnough(masks[i], eroded, options.least)) {
        result.eroded[i + 1] += markEroded(masks[i], eroded, result.labels);
      }
    });
  };
  const Eroder eroder(*labels.blocks, options, passes);
  for (int iteration = 0; iteration < passes.count; ++iteration) {
    erodeEach([&](const FragmentMasks& fragment) { return eroder.erodedIn(fragment, iteration); });
    reportProgress(progress, "erode", static_cast<double>(iteration + 1) / passes.count);
  }
  if (options.islands == Islands::eroded) {
    const std::vector<std::uint64_t> largest = largestComponents(result.labels, device);
    std::vector<std::uint8_t> isLess(masks.size(), 0);  // that part of it than it has to keep
    tbb::parallel_for(std::size_t{0}, masks.size(), [&](std::size_t i) {
      const std::vector<LeafMask> eroded = without(masks[i], largest);
      if (areEmpty(eroded)) return;
      isLess[i] = leavesEnough(masks[i], eroded, options.least) ? 0 : 1;
      if (isLess[i] == 0) result.eroded[i + 1] += markEroded(masks[i], eroded, result.labels);
    });
    tbb::parallel_for(std::size_t{0}, masks.size(), [&](std::size_t i) {
      if (isLess[i] == 0) return;
      restore(masks[i], static_cast<std::uint16_t>(i + 1), labels, result.labels);
      masks[i] = whole[i];
      result.eroded[i + 1] = erodeConnected(masks[i], eroder, passes, options.least, result.labels);
    });
  }
  for (std::size_t i = 1; i < result.eroded.size(); ++i) result.eroded[0] += result.eroded[i];
  return result;
}

}  // namespace sherd
