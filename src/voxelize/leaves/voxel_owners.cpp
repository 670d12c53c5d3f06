// The components of a mesh that inside voxels belong to.
#include "voxelize/leaves/voxel_owners.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>

#include "base/cancel_flag.h"
#include "base/infinity.h"
#include "mesh/search/boxes.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// Two voxels side by side lie on both sides of two surfaces: neither is farther from its own.
constexpr double kReach = 1.0;

// Cracks reach three voxels beyond a solid.
constexpr double kNear = kHalfWidthVoxels;

// Components near one leaf: more would be smaller than two voxels.
constexpr std::size_t kMostInALeaf = 256;

constexpr std::size_t kPairsAtOnce = std::size_t{1} << 22;  // are sorted

// Surfaces whose distances differ by less, voxels, are equally near: for each voxel of the
// coordinate, as rounding grows with it.
constexpr double kEquallyNear = 1e-9;

// Returns the part of the pseudonormal of a triangle's surface at the point of it that is nearest
// to p: the normal by the angle of the triangle there.  The sum over all triangles at that point
// has the sign of the side of the surface, at edges and vertices too.
//   source  Baerentzen, Aanaes: Signed distance computation using the angle weighted pseudonormal,
//           2005
glm::dvec3 pseudonormalPart(const std::array<glm::dvec3, 3>& t, const glm::dvec3& nearest) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  if (normal == glm::dvec3(0.0)) return normal;
  const std::array<glm::dvec3, 3> to{t[0] - nearest, t[1] - nearest, t[2] - nearest};
  double angle = 0.0;  // between the corners, seen from the point; of a corner that it is none
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &a = to[k], &b = to[(k + 1) % 3];
    const double lengths = glm::length(a) * glm::length(b);
    if (lengths > 0.0) angle += std::acos(std::clamp(glm::dot(a, b) / lengths, -1.0, 1.0));
  }
  return angle * glm::normalize(normal);
}

// Returns [components] their boxes.
std::vector<Box> boxesOf(const TriangleTree& tree, const MeshComponents& components) {
  std::vector<Box> boxes(components.count, {glm::dvec3(kInfinity), glm::dvec3(-kInfinity)});
  for (std::size_t i = 0; i < components.ofTriangle.size(); ++i) {
    const Box own = boxOf(tree.corners(i));
    Box& box = boxes[components.ofTriangle[tree.source(i)]];
    box = {glm::min(box.min, own.min), glm::max(box.max, own.max)};
  }
  return boxes;
}

}  // namespace

VoxelOwners::VoxelOwners(const LeafBlocks& blocks, const TriangleTree& tree,
                         const MeshComponents& components, const Progress* progress)
    : blocks_(blocks), tree_(tree), components_(components), slot_(blocks.count(), kNone) {
  findNear(progress);
  if (areTooMany_) return;
  for (std::uint32_t leaf = 0; leaf < near_.size(); ++leaf) {
    if (near_[leaf] != kSeveral) continue;
    slot_[leaf] = static_cast<std::uint32_t>(leaves_.size());
    leaves_.push_back(leaf);
  }
  owner_.assign(leaves_.size() * 512, kNone);
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, leaves_.size(), [&](std::size_t slot) {
    if (!stop.isSet()) findOwners(slot);
  });
  stop.throwIfSet();
}

void VoxelOwners::findNear(const Progress* progress) {
  std::vector<std::vector<std::uint32_t>> near(blocks_.count());
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, near.size(), [&](std::size_t leaf) {
    if (stop.isSet()) return;
    const openvdb::Coord& origin = blocks_.origins[leaf];
    const glm::dvec3 corner(origin.x(), origin.y(), origin.z());
    std::vector<std::uint32_t>& own = near[leaf];
    for (const std::uint32_t t : tree_.meeting(widened({corner, corner + 7.0}, kNear))) {
      own.push_back(components_.ofTriangle[tree_.source(t)]);
    }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  });
  stop.throwIfSet();
  const std::vector<Box> boxes = boxesOf(tree_, components_);
  const auto sortPairs = [&] {
    std::sort(nearPairs_.begin(), nearPairs_.end());
    nearPairs_.erase(std::unique(nearPairs_.begin(), nearPairs_.end()), nearPairs_.end());
  };
  std::size_t enough = kPairsAtOnce;
  for (const std::vector<std::uint32_t>& own : near) {
    near_.push_back(own.empty() ? kNone : own.size() == 1 ? own.front() : kSeveral);
    areTooMany_ = areTooMany_ || own.size() > kMostInALeaf;
    for (std::size_t i = 0; i < own.size() && !areTooMany_; ++i) {
      const Box reach = widened(boxes[own[i]], kNear);
      for (std::size_t k = i + 1; k < own.size(); ++k) {
        if (meet(reach, boxes[own[k]])) nearPairs_.push_back({own[i], own[k]});
      }
    }
    if (nearPairs_.size() < enough) continue;
    throwIfCancelled(progress);
    sortPairs();
    enough = 2 * nearPairs_.size() + kPairsAtOnce;
  }
  sortPairs();
}

void VoxelOwners::findOwners(std::size_t slot) {
  std::uint32_t guess = TriangleTree::kNone;
  for (std::size_t v = 0; v < 512; ++v) {
    const std::size_t voxel = std::size_t{leaves_[slot]} * 512 + v;
    if (!blocks_.isInside(voxel)) continue;
    const openvdb::Coord at = blocks_.voxelAt(voxel);
    const TriangleTree::Nearest nearest =
        tree_.nearest(glm::dvec3(at.x(), at.y(), at.z()), kReach, guess);
    if (nearest.triangle == TriangleTree::kNone) continue;
    guess = nearest.triangle;
    owner_[slot * 512 + v] = ownerAt(glm::dvec3(at.x(), at.y(), at.z()), nearest);
  }
}

std::uint32_t VoxelOwners::ownerAt(const glm::dvec3& p,
                                   const TriangleTree::Nearest& nearest) const {
  const auto componentOf = [&](std::uint32_t t) { return components_.ofTriangle[tree_.source(t)]; };
  const std::array<glm::dvec3, 3> own = tree_.corners(nearest.triangle);
  const ClosestOfTriangle closest = closestOfTriangle(p, own[0], own[1], own[2]);
  const glm::dvec3 normal = glm::cross(own[1] - own[0], own[2] - own[0]);
  if (closest.feature == TriangleFeature::face && glm::dot(normal, p - closest.point) < 0.0) {
    return componentOf(nearest.triangle);
  }
  // The voxel is inside, and may be in front of its nearest surface.
  const double reach = nearest.distance + kEquallyNear * (1.0 + glm::length(p));
  std::map<std::uint32_t, double> side;  // of components: below 0 behind them
  for (const std::uint32_t t : tree_.meeting({p - reach, p + reach})) {
    const std::array<glm::dvec3, 3> corners = tree_.corners(t);
    const glm::dvec3 at = nearestOnTriangle(p, corners[0], corners[1], corners[2]);
    if (glm::length(p - at) > reach) continue;
    side[componentOf(t)] += glm::dot(pseudonormalPart(corners, at), p - at);
  }
  const auto least = std::ranges::min_element(
      side, [](const auto& one, const auto& other) { return one.second < other.second; });
  return least == side.end() ? componentOf(nearest.triangle) : least->first;
}

std::uint32_t VoxelOwners::ownerOf(std::size_t voxel) const {
  const openvdb::Coord at = blocks_.voxelAt(voxel);
  const TriangleTree::Nearest nearest = tree_.nearest(glm::dvec3(at.x(), at.y(), at.z()), kReach);
  if (nearest.triangle == TriangleTree::kNone) return kNone;
  return ownerAt(glm::dvec3(at.x(), at.y(), at.z()), nearest);
}

std::vector<std::array<std::uint32_t, 2>> VoxelOwners::neighbors() const {
  std::vector<std::vector<std::array<std::uint32_t, 2>>> found(leaves_.size());
  tbb::parallel_for(std::size_t{0}, leaves_.size(),
                    [&](std::size_t slot) { addNeighbors(slot, found[slot]); });
  std::vector<std::array<std::uint32_t, 2>> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

void VoxelOwners::addNeighbors(std::size_t slot,
                               std::vector<std::array<std::uint32_t, 2>>& found) const {
  for (std::size_t v = 0; v < 512; ++v) {
    const std::uint32_t own = owner_[slot * 512 + v];
    if (own == kNone) continue;
    const std::size_t voxel = std::size_t{leaves_[slot]} * 512 + v;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t next = voxelBehind(blocks_, voxel, axis);
      if (next == kNoVoxel || slot_[next / 512] == kNone) continue;
      const std::uint32_t other = owner_[std::size_t{slot_[next / 512]} * 512 + next % 512];
      if (other != kNone && other != own) found.push_back({own, other});
    }
  }
}

}  // namespace sherd
