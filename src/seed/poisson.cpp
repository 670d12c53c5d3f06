// Poisson-disk sampling of seeds.
#include "seed/poisson.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/random.h"

namespace sherd {
namespace {

std::int64_t rootRoundedUp(std::int64_t square) {
  auto root = static_cast<std::int64_t>(std::sqrt(static_cast<double>(square)));
  while (root * root < square) ++root;
  while ((root - 1) * (root - 1) >= square) --root;
  return root;
}

// A hash grid of voxels in cubic cells.  Hash collisions only cost extra distance tests.
class CellGrid {
 public:
  CellGrid(std::int64_t side, std::size_t capacity)
      : side_(side), first_(std::bit_ceil(2 * capacity + 1), kNone) {
    voxels_.reserve(capacity);
    next_.reserve(capacity);
  }

  std::int64_t side() const { return side_; }

  void add(const openvdb::Coord& voxel) {
    std::uint32_t& first = first_[bucketOf(cellOf(voxel))];
    next_.push_back(first);
    first = static_cast<std::uint32_t>(voxels_.size());
    voxels_.push_back(voxel);
  }

  // Whether a voxel is nearer than sqrt(square), which is at most the cells' side.
  bool holdsWithin(const openvdb::Coord& voxel, std::int64_t square) const {
    const openvdb::Coord cell = cellOf(voxel);
    if (bucketHoldsWithin(bucketOf(cell), voxel, square)) return true;  // the most frequent case
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dz = -1; dz <= 1; ++dz) {
          if (dx == 0 && dy == 0 && dz == 0) continue;
          if (bucketHoldsWithin(bucketOf(cell.offsetBy(dx, dy, dz)), voxel, square)) return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  openvdb::Coord cellOf(const openvdb::Coord& voxel) const {
    openvdb::Coord cell;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t c = voxel[axis];
      cell[axis] = static_cast<int>(c >= 0 ? c / side_ : -((side_ - 1 - c) / side_));
    }
    return cell;
  }

  std::size_t bucketOf(const openvdb::Coord& cell) const {
    const std::uint64_t hash = static_cast<std::uint64_t>(cell.x()) * 0x9e3779b97f4a7c15u +
                               static_cast<std::uint64_t>(cell.y()) * 0xc2b2ae3d27d4eb4fu +
                               static_cast<std::uint64_t>(cell.z());
    return mixed(hash) & (first_.size() - 1);
  }

  bool bucketHoldsWithin(std::size_t bucket, const openvdb::Coord& voxel,
                         std::int64_t square) const {
    for (std::uint32_t i = first_[bucket]; i != kNone; i = next_[i]) {
      if (metricOrder(Metric::euclidean, voxels_[i], voxel) < square) return true;
    }
    return false;
  }

  std::int64_t side_;
  std::vector<std::uint32_t> first_;  // [bucket] newest voxel
  std::vector<std::uint32_t> next_;   // [voxel] the previous voxel in its bucket
  std::vector<openvdb::Coord> voxels_;
};

}  // namespace

void drawApart(const VoxelIndex& candidates, const VoxelBox& box, std::uint64_t seed,
               std::size_t end, std::uint64_t& dart, Chosen& chosen) {
  constexpr int kMisses = 100;  // in a row: about one dart in fifty would still be accepted
  const auto gridOf = [&](std::int64_t side) {
    CellGrid grid(side, end);
    for (const VoxelKey key : chosen.voxels) grid.add(candidates.voxelAt(key));
    return grid;
  };
  // The squared distance starts at the box's diagonal and shrinks by a sixteenth.
  std::int64_t square = metricOrder(Metric::euclidean, box.min, box.max);
  CellGrid grid = gridOf(std::max<std::int64_t>(rootRoundedUp(square), 1));
  while (square > 1 && chosen.size() < end) {
    const std::int64_t side = rootRoundedUp(square);
    if (side * 5 < grid.side() * 4) grid = gridOf(side);
    for (int misses = 0; misses < kMisses && chosen.size() < end; ++dart) {
      const VoxelKey key =
          candidates.at(randomBelow(candidates.total(), seed, Stage::poissonDart, dart));
      const openvdb::Coord voxel = candidates.voxelAt(key);
      if (grid.holdsWithin(voxel, square)) {
        ++misses;
        continue;
      }
      misses = 0;
      chosen.add(key);
      grid.add(voxel);
    }
    square -= std::max<std::int64_t>(square / 16, 1);
  }
}

}  // namespace sherd
