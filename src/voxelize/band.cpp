// How far voxels are from a surface, where they are near it.
#include "voxelize/band.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/cancel_flag.h"
#include "mesh/boxes.h"
#include "voxelize/discs.h"

namespace sherd {
namespace {

using openvdb::Coord;

constexpr int kLeafSide = 8;

// A thread takes cubes, large ones where there are enough of them: most are far from the surface.
constexpr int kLargestTask = 64, kSmallestTask = 16;
constexpr std::size_t kEnoughTasks = 256;

// Of more triangles near one leaf the tree finds the nearest sooner than a list does.
constexpr std::size_t kMostInList = 8192;

class Search {
 public:
  Search(const TriangleTree& tree, double reach, std::vector<BandLeaf>& leaves, CancelFlag& stop)
      : tree_(tree), reach_(reach), leaves_(leaves), stop_(stop) {}

  // Append a cube's leaves.
  void descend(const Coord& origin, int side, std::uint32_t guess) {
    if (stop_.isSet()) return;
    const Cube cube(origin, side);
    const Nearest near = tree_.nearest(cube.middle, reach_ + cube.radius, guess);
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
    byList_ = triangles.size() <= kMostInList;
    if (byList_) lists_[0].assign(tree_, corner, triangles);
    forEachEighth(origin, side, [&](const Coord& c) { fill(c, side / 2, near.triangle, 0); });
    if (any_) leaves_.push_back(leaf_);
  }

 private:
  using Nearest = TriangleTree::Nearest;

  struct Cube {
    Cube(const Coord& origin, int side)
        : middle(glm::dvec3(origin.x(), origin.y(), origin.z()) + 0.5 * (side - 1)),
          radius(0.5 * (side - 1) * std::numbers::sqrt3) {}
    glm::dvec3 middle;
    double radius;  // of its voxels' centres
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

  // Fill in a part of the leaf, near which are the triangles of a list.
  void fill(const Coord& origin, int side, std::uint32_t guess, std::size_t list) {
    if (side == 1) {
      fill(origin, guess, list);
      return;
    }
    const Cube cube(origin, side);
    const Nearest near = nearest(cube.middle, reach_ + cube.radius, guess, list);
    if (near.triangle == TriangleTree::kNone) return;
    if (byList_) {  // what is nearest to any of the voxels
      const double farthest = std::min(near.distance + cube.radius, reach_);
      lists_[list + 1].assign(lists_[list], farthest + cube.radius);
    }
    forEachEighth(origin, side,
                  [&](const Coord& c) { fill(c, side / 2, near.triangle, list + 1); });
  }

  void fill(const Coord& voxel, std::uint32_t guess, std::size_t list) {
    const Nearest found = nearest({voxel.x(), voxel.y(), voxel.z()}, reach_, guess, list);
    if (found.triangle == TriangleTree::kNone) return;
    const Coord in = voxel - leaf_.origin;
    leaf_.distance[static_cast<std::size_t>(in.x() << 6 | in.y() << 3 | in.z())] =
        static_cast<float>(found.distance);
    any_ = true;
  }

  const TriangleTree& tree_;
  double reach_;
  std::vector<BandLeaf>& leaves_;
  CancelFlag& stop_;
  BandLeaf leaf_;  // being filled
  bool any_ = false, byList_ = false;
  std::array<Discs, 3> lists_;  // near the leaf, a cube of four voxels a side, one of two
};

// The cubes of a lattice that meet a box, by where they begin.
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
  for (const auto& part : found) count += part.size();
  leaves.reserve(count);
  for (std::vector<BandLeaf>& part : found) {
    leaves.insert(leaves.end(), part.begin(), part.end());
    std::vector<BandLeaf>().swap(part);
  }
  return leaves;
}

}  // namespace sherd
