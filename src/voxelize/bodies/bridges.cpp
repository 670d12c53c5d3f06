// Voxels that keep thin walls connected.
#include "voxelize/bodies/bridges.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include "base/cancel_flag.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

using openvdb::Coord;

// Two inside voxels that share only an edge or a corner.
struct Pair {
  Coord a, b;
};

// The inside bits of a leaf and of the next layer of voxels along each axis: bit z of [x][y], with
// x, y and z in 0..8.
using Rows = std::array<std::array<unsigned, 9>, 9>;

Rows rowsOf(const LeafBlocks& blocks, const LeafNeighbors& neighbors) {
  const auto word = [&](int dx, int dy, int dz, int x) -> std::uint64_t {
    const std::uint32_t leaf =
        neighbors[static_cast<std::size_t>((dx + 1) * 9 + (dy + 1) * 3 + dz + 1)];
    return leaf == LeafBlocks::kNone
               ? 0
               : blocks.inside[leaf * std::size_t{8} + static_cast<unsigned>(x)];
  };
  Rows rows{};
  for (int x = 0; x <= 8; ++x) {
    for (int y = 0; y <= 8; ++y) {
      const int shift = 8 * (y & 7);
      const auto row = [&](int dz) {
        return static_cast<unsigned>(word(x >> 3, y >> 3, dz, x & 7) >> shift) & 0xffu;
      };
      rows[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)] = row(0) | (row(1) & 1u) << 8;
    }
  }
  return rows;
}

// Adds the pairs a + z, b + z for each bit z below 8.
void addPairs(unsigned bits, const Coord& a, const Coord& b, std::vector<Pair>& pairs) {
  for (bits &= 0xffu; bits != 0; bits &= bits - 1) {
    const Coord up(0, 0, std::countr_zero(bits));
    pairs.push_back({a + up, b + up});
  }
}

// Adds the diagonal pairs of 2x2 squares whose other two voxels are outside.
void addSquares(const Rows& rows, const Coord& origin, std::vector<Pair>& pairs) {
  // p, q, r and s go around the square; p and r are inside.
  const auto diagonal = [](unsigned p, unsigned q, unsigned r, unsigned s) {
    return p & r & ~(q | s);
  };
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      const auto at = [&](int dx, int dy) {
        return rows[static_cast<std::size_t>(x + dx)][static_cast<std::size_t>(y + dy)];
      };
      const Coord here = origin + Coord(x, y, 0);
      const unsigned r = at(0, 0), alongX = at(1, 0), alongY = at(0, 1), both = at(1, 1);
      addPairs(diagonal(r, alongX, both, alongY), here, here + Coord(1, 1, 0), pairs);
      addPairs(diagonal(alongX, r, alongY, both), here + Coord(1, 0, 0), here + Coord(0, 1, 0),
               pairs);
      for (const auto& [next, step] :
           {std::pair{alongX, Coord(1, 0, 0)}, std::pair{alongY, Coord(0, 1, 0)}}) {
        const Coord up(0, 0, 1);
        addPairs(diagonal(r, r >> 1, next >> 1, next), here, here + step + up, pairs);
        addPairs(diagonal(r >> 1, r, next, next >> 1), here + up, here + step, pairs);
      }
    }
  }
}

// Adds the diagonal pairs of 2x2x2 cubes whose other six voxels are outside.
void addCubes(const Rows& rows, const Coord& origin, std::vector<Pair>& pairs) {
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      std::array<std::array<unsigned, 2>, 4> r{};  // [dx * 2 + dy][dz]
      for (int i = 0; i < 4; ++i) {
        const unsigned row =
            rows[static_cast<std::size_t>(x + i / 2)][static_cast<std::size_t>(y + i % 2)];
        r[static_cast<std::size_t>(i)] = {row, row >> 1};
      }
      const Coord here = origin + Coord(x, y, 0);
      for (int low = 0; low < 4; ++low) {  // the pair's end at dz = 0
        unsigned others = 0;
        for (int i = 0; i < 4; ++i) {
          if (i != low) others |= r[static_cast<std::size_t>(i)][0];
          if (i != 3 - low) others |= r[static_cast<std::size_t>(i)][1];
        }
        const unsigned bits =
            r[static_cast<std::size_t>(low)][0] & r[static_cast<std::size_t>(3 - low)][1] & ~others;
        addPairs(bits, here + Coord(low / 2, low % 2, 0), here + Coord(1 - low / 2, 1 - low % 2, 1),
                 pairs);
      }
    }
  }
}

glm::dvec3 pointOf(const Coord& c) { return {c.x(), c.y(), c.z()}; }

class Bridges {
 public:
  Bridges(const LeafBlocks& blocks, const Filling& filling, const Progress* progress)
      : blocks_(blocks),
        filling_(filling),
        stop_(progress),
        leafNeighbors_(leafNeighbors(blocks.origins)) {}

  std::vector<std::size_t> find() {
    join(addSquares);
    join(addCubes);
    std::sort(added_.begin(), added_.end());
    return std::move(added_);
  }

 private:
  template <class Add>
  void join(const Add& add) {
    std::vector<std::vector<Coord>> ofLeaf(blocks_.count());
    tbb::parallel_for(std::size_t{0}, blocks_.count(), [&](std::size_t leaf) {
      if (stop_.isSet()) return;
      std::vector<Pair> pairs;
      add(rowsOf(blocks_, leafNeighbors_[leaf]), blocks_.origins[leaf], pairs);
      for (const Pair& pair : pairs) {
        if (!areJoined(pair) && isSegmentInside(pair)) addPath(pair, ofLeaf[leaf]);
      }
    });
    stop_.throwIfSet();
    for (const std::vector<Coord>& voxels : ofLeaf) {
      for (const Coord& voxel : voxels) {
        const std::uint32_t leaf = findLeaf(blocks_, voxel);
        if (leaf == LeafBlocks::kNone) continue;
        const std::size_t voxelIndex = leaf * std::size_t{512} + offsetFromCoord(voxel);
        if (blocks_.isInside(voxelIndex)) continue;
        blocks_.inside[voxelIndex / 64] |= std::uint64_t{1} << (voxelIndex % 64);
        added_.push_back(voxelIndex);
      }
    }
  }

  bool isInside(const Coord& voxel) const {
    const std::uint32_t leaf = findLeaf(blocks_, voxel);
    return leaf != LeafBlocks::kNone &&
           blocks_.isInside(leaf * std::size_t{512} + offsetFromCoord(voxel));
  }

  // Whether a 6-connected path joins the pair, at most one voxel away from it: at a sharp edge of a
  // solid one does, deeper inside.
  bool areJoined(const Pair& pair) const {
    const Coord low = Coord::minComponent(pair.a, pair.b) - Coord(1, 1, 1);
    const Coord high = Coord::maxComponent(pair.a, pair.b) + Coord(1, 1, 1);
    std::vector<Coord> reached{pair.a};
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (int k = 0; k < 6; ++k) {
        Coord next = reached[i];
        next[k / 2] += k % 2 == 0 ? -1 : 1;
        if (next[k / 2] < low[k / 2] || next[k / 2] > high[k / 2] || !isInside(next) ||
            std::find(reached.begin(), reached.end(), next) != reached.end()) {
          continue;
        }
        if (next == pair.b) return true;
        reached.push_back(next);
      }
    }
    return false;
  }

  bool isSegmentInside(const Pair& pair) const {
    const glm::dvec3 a = pointOf(pair.a), b = pointOf(pair.b);
    if (filling_.halfThickness > 0.0) return distanceAt(0.5 * (a + b)) < filling_.halfThickness;
    return filling_.surface->firstHit(a, b - a, 0.0) > 1.0;
  }

  double distanceAt(const glm::dvec3& point) const {
    constexpr double kFar = 3.0;  // voxels; every point between the two voxels is nearer
    return filling_.surface->nearest(point, kFar).distance;
  }

  // Adds the voxels of a shortest path from a to b; each step goes to the voxel nearest to the
  // surface.
  void addPath(const Pair& pair, std::vector<Coord>& path) const {
    Coord at = pair.a;
    for (;;) {
      double least = kFarther;
      Coord best = at;
      int steps = 0;
      for (int axis = 0; axis < 3; ++axis) {
        if (at[axis] == pair.b[axis]) continue;
        ++steps;
        Coord next = at;
        next[axis] = pair.b[axis];
        const double distance = distanceAt(pointOf(next));
        if (distance < least) least = distance, best = next;
      }
      if (steps < 2) return;
      path.push_back(best);
      at = best;
    }
  }

  static constexpr double kFarther = 1e300;

  LeafBlocks blocks_;
  const Filling& filling_;
  CancelFlag stop_;
  std::vector<LeafNeighbors> leafNeighbors_;
  std::vector<std::size_t> added_;
};

}  // namespace

std::vector<std::size_t> bridgesOf(const LeafBlocks& blocks, const Filling& filling,
                                   const Progress* progress) {
  return Bridges(blocks, filling, progress).find();
}

}  // namespace sherd
