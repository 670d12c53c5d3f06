// Poisson-disk sampling of seeds.
#include "seed/draw/poisson.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/cancel_flag.h"
#include "base/random.h"
#include "seed/draw/draws.h"

namespace sherd {
namespace {

std::int64_t rootRoundedUp(std::int64_t square) {
  auto root = static_cast<std::int64_t>(std::sqrt(static_cast<double>(square)));
  while (root * root < square) ++root;
  while ((root - 1) * (root - 1) >= square) --root;
  return root;
}

// A hash grid of points in cubic cells.  Hash collisions only cost extra distance tests.
class CellGrid {
 public:
  CellGrid(std::int64_t side, std::size_t capacity)
      : side_(side), first_(std::bit_ceil(2 * capacity + 1), kNone) {
    points_.reserve(capacity);
    next_.reserve(capacity);
  }

  std::int64_t side() const { return side_; }

  void add(const glm::i64vec3& point) {
    std::uint32_t& first = first_[bucketOf(cellOf(point))];
    next_.push_back(first);
    first = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
  }

  // Whether a point is nearer than sqrt(square), which is at most the cells' side.
  bool holdsWithin(const glm::i64vec3& point, std::int64_t square) const {
    const glm::i64vec3 cell = cellOf(point);
    if (bucketHoldsWithin(bucketOf(cell), point, square)) return true;  // the most frequent case
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dz = -1; dz <= 1; ++dz) {
          if (dx == 0 && dy == 0 && dz == 0) continue;
          if (bucketHoldsWithin(bucketOf(cell + glm::i64vec3(dx, dy, dz)), point, square))
            return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  glm::i64vec3 cellOf(const glm::i64vec3& point) const {
    glm::i64vec3 cell;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t c = point[axis];
      cell[axis] = c >= 0 ? c / side_ : -((side_ - 1 - c) / side_);
    }
    return cell;
  }

  std::size_t bucketOf(const glm::i64vec3& cell) const {
    const std::uint64_t hash = static_cast<std::uint64_t>(cell.x) * 0x9e3779b97f4a7c15u +
                               static_cast<std::uint64_t>(cell.y) * 0xc2b2ae3d27d4eb4fu +
                               static_cast<std::uint64_t>(cell.z);
    return mixed(hash) & (first_.size() - 1);
  }

  bool bucketHoldsWithin(std::size_t bucket, const glm::i64vec3& point, std::int64_t square) const {
    for (std::uint32_t i = first_[bucket]; i != kNone; i = next_[i]) {
      const glm::i64vec3 apart = points_[i] - point;
      if (metricOrder(Metric::euclidean, apart.x, apart.y, apart.z) < square) return true;
    }
    return false;
  }

  std::int64_t side_;
  std::vector<std::uint32_t> first_;  // [bucket] newest point
  std::vector<std::uint32_t> next_;   // [point] the previous one in its bucket
  std::vector<glm::i64vec3> points_;
};

}  // namespace

void drawApart(const Candidates& candidates, std::uint64_t seed, std::size_t end,
               std::uint64_t& dart, Chosen& chosen, const std::function<void()>& drawAnew,
               const Progress* progress) {
  constexpr int kMisses = 100;  // in a row: about one dart in fifty would still be accepted
  constexpr std::uint64_t kMost = 1 << 24;  // darts, those beside the solid included
  constexpr std::int64_t kLeast = 256;      // a 4096th of the longest side
  const auto gridOf = [&](std::int64_t side) {
    CellGrid grid(side, end);
    for (const Candidate& each : chosen.all()) grid.add(each.inSpace);
    return grid;
  };
  // The squared distance starts at the box's diagonal and shrinks by a sixteenth.
  const glm::i64vec3 sides = candidates.stepsOfBox();
  std::int64_t square = metricOrder(Metric::euclidean, sides.x, sides.y, sides.z);
  CellGrid grid = gridOf(std::max<std::int64_t>(rootRoundedUp(square), 1));
  const std::uint64_t last = dart + kMost;
  // Once only components without a seed are left, darts hardly ever meet them.
  const auto goesOn = [&] { return end - chosen.size() > chosen.unseeded() && dart < last; };
  while (square > kLeast * kLeast && goesOn()) {
    const std::int64_t side = rootRoundedUp(square);
    if (side * 5 < grid.side() * 4) grid = gridOf(side);
    for (int misses = 0; misses < kMisses && goesOn(); ++dart) {
      throwIfCancelled(progress);
      const auto found = candidates.inBox(randomPoint(seed, Stage::poissonDart, dart));
      if (!found) continue;
      if (grid.holdsWithin(found->inSpace, square)) {
        ++misses;
        continue;
      }
      misses = 0;
      grid.add(found->inSpace);
      if (chosen.add(*found)) continue;
      drawAnew();
      grid.add(chosen.all().back().inSpace);
    }
    square -= square / 16;
  }
}

}  // namespace sherd
