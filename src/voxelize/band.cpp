// How far voxels are from a surface, where they are near it.
#include "voxelize/band.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cancel_flag.h"

namespace sherd {
namespace {

using openvdb::Coord;

constexpr int kLeafSide = 8;
constexpr int kTaskSide = 64;

// Cubes are halved while one query of the middle saves more than it costs; pairs of voxels are
// asked one by one.
constexpr int kSmallestCube = 2;

struct Search {
  const TriangleTree& tree;
  double reach;
  std::vector<BandLeaf>& leaves;

  // The nearest triangle to a cube's middle, if the surface is near any of its voxels.
  [[nodiscard]] TriangleTree::Nearest middleOf(const Coord& origin, int side,
                                               std::uint32_t guess) const {
    const double half = 0.5 * (side - 1);
    const glm::dvec3 middle(origin.x() + half, origin.y() + half, origin.z() + half);
    return tree.nearest(middle, reach + half * std::numbers::sqrt3, guess);
  }

  template <class Visit>
  static void forEachEighth(const Coord& origin, int side, Visit&& visit) {
    for (int k = 0; k < 8; ++k) {
      visit(origin + Coord((k >> 2 & 1) * side / 2, (k >> 1 & 1) * side / 2, (k & 1) * side / 2));
    }
  }

  void descend(const Coord& origin, int side, std::uint32_t guess) const {
    const TriangleTree::Nearest near = middleOf(origin, side, guess);
    if (near.triangle == TriangleTree::kNone) return;
    if (side > kLeafSide) {
      forEachEighth(origin, side, [&](const Coord& c) { descend(c, side / 2, near.triangle); });
      return;
    }
    BandLeaf leaf;
    leaf.origin = origin;
    leaf.distance.fill(std::numeric_limits<float>::infinity());
    bool any = false;
    forEachEighth(origin, side,
                  [&](const Coord& c) { fill(leaf, c, side / 2, near.triangle, any); });
    if (any) leaves.push_back(leaf);
  }

  void fill(BandLeaf& leaf, const Coord& origin, int side, std::uint32_t guess, bool& any) const {
    const TriangleTree::Nearest near = middleOf(origin, side, guess);
    if (near.triangle == TriangleTree::kNone) return;
    if (side > kSmallestCube) {
      forEachEighth(origin, side,
                    [&](const Coord& c) { fill(leaf, c, side / 2, near.triangle, any); });
      return;
    }
    for (int x = 0; x < side; ++x) {
      for (int y = 0; y < side; ++y) {
        for (int z = 0; z < side; ++z) {
          const Coord voxel = origin + Coord(x, y, z);
          const TriangleTree::Nearest found =
              tree.nearest({voxel.x(), voxel.y(), voxel.z()}, reach, near.triangle);
          if (found.triangle == TriangleTree::kNone) continue;
          const Coord in = voxel - leaf.origin;
          leaf.distance[static_cast<std::size_t>(in.x() << 6 | in.y() << 3 | in.z())] =
              static_cast<float>(found.distance);
          any = true;
        }
      }
    }
  }
};

}  // namespace

std::vector<BandLeaf> bandOf(const TriangleTree& tree, double reach, const Progress* progress) {
  const Box box = tree.box();
  std::vector<Coord> cubes;
  Coord low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = static_cast<int>(std::floor((box.min[axis] - reach) / kTaskSide));
    high[axis] = static_cast<int>(std::floor((box.max[axis] + reach) / kTaskSide));
  }
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        cubes.emplace_back(x * kTaskSide, y * kTaskSide, z * kTaskSide);
      }
    }
  }
  std::vector<std::vector<BandLeaf>> found(cubes.size());
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, cubes.size(), [&](std::size_t i) {
    if (stop.isSet()) return;
    Search{tree, reach, found[i]}.descend(cubes[i], kTaskSide, TriangleTree::kNone);
  });
  stop.throwIfSet();
  std::vector<BandLeaf> leaves;
  std::size_t count = 0;
  for (const auto& part : found) count += part.size();
  leaves.reserve(count);
  for (std::vector<BandLeaf>& part : found) {
    leaves.insert(leaves.end(), part.begin(), part.end());
    std::vector<BandLeaf>().swap(part);
  }
  return leaves;
}

}  // namespace sherd
