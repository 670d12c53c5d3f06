// Voxels of leaf masks by number, key and coordinates.
#include "seed/draw/voxel_index.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

constexpr std::uint64_t kRowEnds = 0x8080808080808080u;  // z = 7 of each row of a slab

std::uint64_t nthBit(std::uint64_t bits, std::uint64_t n) {
  for (; n > 0; --n) bits &= bits - 1;
  return static_cast<std::uint64_t>(std::countr_zero(bits));
}

double squared(const glm::dvec3& d) { return d.x * d.x + d.y * d.y + d.z * d.z; }

// Returns the squared distance to the nearest voxel center of the leaf.  Every operation is
// monotone, so rounding never makes it larger than the computed distance of one of its voxels.
double distanceToLeaf(const openvdb::Coord& origin, const glm::dvec3& point) {
  glm::dvec3 gap(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    gap[axis] = std::max({origin[axis] - point[axis], point[axis] - (origin[axis] + 7), 0.0});
  }
  return squared(gap);
}

}  // namespace

std::vector<std::uint64_t> surfaceMask(const LeafBlocks& blocks) {
  const std::span<const std::uint64_t> inside = blocks.inside;
  std::vector<std::uint64_t> surface(inside.size());
  for (std::size_t word = 0; word < inside.size(); ++word) {
    if (!inside[word]) continue;
    const std::size_t leaf = word / 8, x = word % 8;
    // Returns a slab of the neighboring leaf on a side.
    const auto beside = [&](std::size_t side, std::size_t slab) -> std::uint64_t {
      const std::uint32_t other = blocks.neighbors[leaf * 6 + side];
      return other == LeafBlocks::kNone ? 0 : inside[other * std::size_t{8} + slab];
    };
    const std::uint64_t own = inside[word];
    const std::uint64_t lowerX = x > 0 ? inside[word - 1] : beside(0, 7);
    const std::uint64_t upperX = x < 7 ? inside[word + 1] : beside(1, 0);
    const std::uint64_t lowerY = own << 8 | beside(2, x) >> 56;
    const std::uint64_t upperY = own >> 8 | beside(3, x) << 56;
    const std::uint64_t lowerZ = (own & ~kRowEnds) << 1 | (beside(4, x) & kRowEnds) >> 7;
    const std::uint64_t upperZ = (own >> 1 & ~kRowEnds) | (beside(5, x) << 7 & kRowEnds);
    surface[word] = own & ~(lowerX & upperX & lowerY & upperY & lowerZ & upperZ);
  }
  return surface;
}

VoxelIndex::VoxelIndex(const LeafBlocks& blocks, std::span<const std::uint64_t> mask)
    : blocks_(blocks), mask_(mask) {
  before_.reserve(mask.size());
  for (const std::uint64_t word : mask) {
    before_.push_back(total_);
    total_ += static_cast<std::uint64_t>(std::popcount(word));
  }
}

VoxelKey VoxelIndex::at(std::uint64_t number) const {
  const auto word =
      static_cast<std::size_t>(std::upper_bound(before_.begin(), before_.end(), number) -
                               before_.begin()) -
      1;
  return word * 64 + nthBit(mask_[word], number - before_[word]);
}

std::optional<VoxelKey> VoxelIndex::find(const openvdb::Coord& voxel) const {
  const std::uint32_t leaf = findLeaf(blocks_, voxel);
  if (leaf == LeafBlocks::kNone) return {};
  const VoxelKey key = std::uint64_t{leaf} * 512 + offsetFromCoord(voxel);
  if (!((mask_[key / 64] >> (key % 64)) & 1)) return {};
  return key;
}

openvdb::Coord VoxelIndex::nearest(const glm::dvec3& point) const {
  openvdb::Coord best;
  double bestDistance = std::numeric_limits<double>::infinity();
  bool found = false;
  const auto searchLeaf = [&](std::size_t leaf) {
    for (std::size_t word = leaf * 8; word < leaf * 8 + 8; ++word) {
      for (std::uint64_t bits = mask_[word]; bits; bits &= bits - 1) {
        const openvdb::Coord voxel =
            voxelAt(word * 64 + static_cast<std::uint64_t>(std::countr_zero(bits)));
        const double distance = squared(centerOf(voxel) - point);
        if (found && (distance > bestDistance || (distance == bestDistance && best < voxel))) {
          continue;
        }
        best = voxel;
        bestDistance = distance;
        found = true;
      }
    }
  };
  // The leaf with the least bound comes first, so that few others need to be searched.
  std::size_t first = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t leaf = 0; leaf < blocks_.count(); ++leaf) {
    const double bound = distanceToLeaf(blocks_.origins[leaf], point);
    if (bound >= least) continue;
    const auto words = mask_.subspan(leaf * 8, 8);
    if (std::all_of(words.begin(), words.end(), [](std::uint64_t w) { return w == 0; })) continue;
    least = bound;
    first = leaf;
  }
  searchLeaf(first);
  for (std::size_t leaf = 0; leaf < blocks_.count(); ++leaf) {
    if (leaf != first && distanceToLeaf(blocks_.origins[leaf], point) <= bestDistance) {
      searchLeaf(leaf);
    }
  }
  return best;
}

std::optional<VoxelKey> VoxelIndex::nearestWithin(
    const glm::dvec3& point, double reach, const std::function<bool(VoxelKey)>& accepts) const {
  constexpr double kBeyond = 1 << 30;  // outside every solid, and still fits an int
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(point[axis]) < kBeyond)) return {};
  }
  // Mostly it is the voxel that contains the point, unless that lies on a face.
  const glm::dvec3 rounded = glm::floor(point + 0.5);
  const glm::dvec3 off = glm::abs(rounded - point);
  if (off.x < 0.5 && off.y < 0.5 && off.z < 0.5) {
    const std::optional<VoxelKey> key = find(
        {static_cast<int>(rounded.x), static_cast<int>(rounded.y), static_cast<int>(rounded.z)});
    if (key && accepts(*key)) return key;
  }
  const auto low = [&](int axis) { return static_cast<int>(std::ceil(point[axis] - reach)); };
  const auto high = [&](int axis) { return static_cast<int>(std::floor(point[axis] + reach)); };
  std::optional<VoxelKey> best;
  double least = reach * reach;
  for (int x = low(0); x <= high(0); ++x) {
    for (int y = low(1); y <= high(1); ++y) {
      for (int z = low(2); z <= high(2); ++z) {
        const double square = squared(glm::dvec3(x, y, z) - point);
        if (square > least || (best && square == least)) continue;
        const std::optional<VoxelKey> key = find({x, y, z});
        if (!key || !accepts(*key)) continue;
        best = key;
        least = square;
      }
    }
  }
  return best;
}

std::vector<std::uint64_t> VoxelIndex::countInComponents(const VoxelComponents& components) const {
  if (total_ == 0 || components.count() == 1)
    return std::vector<std::uint64_t>(components.count(), total_);
  std::vector<std::uint64_t> count(components.count());
  forEach([&](VoxelKey key) { ++count[components.at(key)]; });
  return count;
}

std::vector<VoxelKey> VoxelIndex::atInComponents(const VoxelComponents& components,
                                                 std::vector<std::uint64_t> number) const {
  if (components.count() == 1) return {at(number[0])};
  std::vector<VoxelKey> found(number.size());
  std::vector<bool> done(number.size());
  forEach([&](VoxelKey key) {
    const std::uint32_t component = components.at(key);
    if (done[component] || number[component]-- > 0) return;
    found[component] = key;
    done[component] = true;
  });
  return found;
}

}  // namespace sherd
