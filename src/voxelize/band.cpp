// Distances from voxels to a surface, in a band around it.
#include "voxelize/band.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/cancel_flag.h"
#include "mesh/search/boxes.h"
#include "voxelize/discs.h"

namespace sherd {
namespace {

using openvdb::Coord;

constexpr int kLeafSide = 8;

// Tasks are cubes, large ones where there are enough: most are far from the surface.
constexpr int kLargestTask = 64, kSmallestTask = 16;
constexpr std::size_t kEnoughTasks = 256;

// For more triangles than this near one leaf, the tree is faster than a list.
constexpr std::size_t kMaxListSize = 8192;

class Search {
 public:
  Search(const TriangleTree& tree, double reach, std::vector<BandLeaf>& leaves, CancelFlag& stop)
      : tree_(tree), reach_(reach), leaves_(leaves), stop_(stop) {}

  // Appends the leaves of a cube.
  void descend(const Coord& origin, int side, std::uint32_t guess) {
    if (stop_.isSet()) return;
    const Cube cube(origin, side);
    const Nearest near = tree_.nearest(cube.center, reach_ + cube.radius, guess);
    if (near.triangle == TriangleTree::kNone) return;
    if (side > kLeafSide) {
      forEachEighth(origin, side, [&](const Coord& c) { descend(c, side / 2, near.triangle); });
      return;
    }
    leaf_.origin = origin;
    leaf_.distance.fill(std::numeric_limits<float>::infinity());
    any_ = false;
    const glm::dvec3 corner(origin.x(), origin.y(), origin.z());
    const std::vector<std::uint32_t> triangles =
        tree_.meeting(widened({corner, corner + (kLeafSide - 1.0)}, reach_));
    byList_ = triangles.size() <= kMaxListSize;
    if (byList_) lists_[0].assign(tree_, corner, triangles);
    forEachEighth(origin, side, [&](const Coord& c) { fill(c, side / 2, near.triangle, 0); });
    if (any_) leaves_.push_back(leaf_);
  }

 private:
  using Nearest = TriangleTree::Nearest;

  struct Cube {
    Cube(const Coord& origin, int side)
        : center(glm::dvec3(origin.x(), origin.y(), origin.z()) + 0.5 * (side - 1)),
          radius(0.5 * (side - 1) * std::numbers::sqrt3) {}
    glm::dvec3 center;
    double radius;  // of the ball around all voxel centers of the cube
  };

  template <class Visit>
  static void forEachEighth(const Coord& origin, int side, Visit&& visit) {
    for (int k = 0; k < 8; ++k) {
      visit(origin + Coord((k >> 2 & 1) * side / 2, (k >> 1 & 1) * side / 2, (k & 1) * side / 2));
    }
  }

  [[nodiscard]] Nearest nearest(const glm::dvec3& point, double reach, std::uint32_t guess,
                                std::size_t list) {
    return byList_ ? lists_[list].nearest(point, reach, guess) : tree_.nearest(point, reach, guess);
  }

  // Fills a cube of the leaf from the triangles of a list.
  void fill(const Coord& origin, int side, std::uint32_t guess, std::size_t list) {
    if (side == 1) {
      fill(origin, guess, list);
      return;
    }
    const Cube cube(origin, side);
    const Nearest near = nearest(cube.center, reach_ + cube.radius, guess, list);
    if (near.triangle == TriangleTree::kNone) return;
    if (byList_) {  // keep the triangles that may be nearest to one of the voxels
      const double farthest = std::min(near.distance + cube.radius, reach_);
      lists_[list + 1].assign(lists_[list], farthest + cube.radius);
    }
    forEachEighth(origin, side,
                  [&](const Coord& c) { fill(c, side / 2, near.triangle, list + 1); });
  }

  void fill(const Coord& voxel, std::uint32_t guess, std::size_t list) {
    const Nearest found = nearest({voxel.x(), voxel.y(), voxel.z()}, reach_, guess, list);
    if (found.triangle == TriangleTree::kNone) return;
    const Coord local = voxel - leaf_.origin;
    leaf_.distance[static_cast<std::size_t>(local.x() << 6 | local.y() << 3 | local.z())] =
        static_cast<float>(found.distance);
    any_ = true;
  }

  const TriangleTree& tree_;
  double reach_;
  std::vector<BandLeaf>& leaves_;
  CancelFlag& stop_;
  BandLeaf leaf_;  // being filled
  bool any_ = false, byList_ = false;
  std::array<Discs, 3> lists_;  // triangles near the leaf, near its cube of side 4, and of side 2
};

// Returns the origins of the lattice cubes that intersect a box.
std::vector<Coord> cubesOf(const Box& box, int side) {
  const auto first = [side](double v) { return static_cast<int>(std::floor(v / side)) * side; };
  std::vector<Coord> cubes;
  for (int x = first(box.min.x); x <= box.max.x; x += side) {
    for (int y = first(box.min.y); y <= box.max.y; y += side) {
      for (int z = first(box.min.z); z <= box.max.z; z += side) cubes.emplace_back(x, y, z);
    }
  }
  return cubes;
}

}  // namespace

std::vector<BandLeaf> bandOf(const TriangleTree& tree, double reach, const Progress* progress) {
  const Box box = widened(tree.box(), reach);
  int side = kLargestTask;
  std::vector<Coord> cubes = cubesOf(box, side);
  while (cubes.size() < kEnoughTasks && side > kSmallestTask) cubes = cubesOf(box, side /= 2);
  std::vector<std::vector<BandLeaf>> found(cubes.size());
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, cubes.size(), [&](std::size_t i) {
    Search(tree, reach, found[i], stop).descend(cubes[i], side, TriangleTree::kNone);
  });
  stop.throwIfSet();
  std::vector<BandLeaf> leaves;
  std::size_t count = 0;
  for (const auto& cubeLeaves : found) count += cubeLeaves.size();
  leaves.reserve(count);
  for (std::vector<BandLeaf>& cubeLeaves : found) {
    leaves.insert(leaves.end(), cubeLeaves.begin(), cubeLeaves.end());
    std::vector<BandLeaf>().swap(cubeLeaves);
  }
  return leaves;
}

}  // namespace sherd
