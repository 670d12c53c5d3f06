// Labels that agree with exact meshes.
#include "surface/exact/settled_labels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <set>
#include <utility>
#include <vector>

#include "erode/largest_part.h"
#include "erode/masks.h"
#include "mesh/search/triangle_tree.h"
#include "surface/exact/exact_meshes.h"
#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/leaves/spread.h"

namespace sherd {
namespace {

// How often the cut is made anew.
constexpr int kMostRounds = 3;

// How far labels of the exterior band are from the voxels that they come from.
constexpr int kBandReach = 6;

// The voxels whose centers a body's box holds.
openvdb::math::CoordBBox voxelsWithin(const Solid& solid, const TriangleMesh& body) {
  const Box box = bounds(body);
  const glm::dvec3 low = glm::ceil(solid.frame.indexFromWorld(box.min)),
                   high = glm::floor(solid.frame.indexFromWorld(box.max));
  const auto coordOf = [](const glm::dvec3& p) {
    return openvdb::Coord(static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z));
  };
  return {coordOf(low), coordOf(high)};
}

// Visits the voxels of all leaves that a box meets, with their positions.
template <class Visit>
void forEachVoxel(const LeafBlocks& blocks, const openvdb::math::CoordBBox& box,
                  const Visit& visit) {
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    const auto own = openvdb::math::CoordBBox::createCube(blocks.origins[leaf], 8);
    if (!own.hasOverlap(box)) continue;
    for (std::size_t voxel = leaf * 512; voxel < leaf * 512 + 512; ++voxel) {
      const openvdb::Coord at = blocks.voxelAt(voxel);
      if (box.isInside(at)) visit(voxel, at);
    }
  }
}

// Returns the voxels of a fragment within a body that it lost.
std::vector<std::size_t> lostVoxels(const Solid& solid, const Labels& labels,
                                    const MovedBody& moved) {
  const double least =
      0.5 * std::pow(solid.frame.voxelSize, 3) * static_cast<double>(kSmallComponentVoxels);
  if (volume(moved.body) < least) return {};
  const TriangleTree tree(moved.body);
  std::vector<std::size_t> found;
  forEachVoxel(*labels.blocks, voxelsWithin(solid, moved.body),
               [&](std::size_t voxel, const openvdb::Coord& at) {
                 if (!labels.blocks->isInside(voxel) || labels.fragment[voxel] != moved.from)
                   return;
                 const glm::dvec3 center(at.x(), at.y(), at.z());
                 if (tree.winding(solid.frame.worldFromIndex(center)) < 0.5) return;
                 found.push_back(voxel);
               });
  return found;
}

// Gives what a fragment has left beside its largest part, and its labels of the exterior band near
// the voxels that it lost, to the fragments beside them.
void tidy(const Solid& solid, Labels& labels, const MovedBody& moved, std::set<int>& changed,
          const Progress* progress) {
  const LeafBlocks& blocks = *labels.blocks;
  const FragmentMasks own = fragmentMasks(labels)[moved.from - 1u];
  const LargestPart largest = largestPart(own);
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < own.leaf.size(); ++i) {
    for (std::size_t bit = 0; bit < 512; ++bit) {
      const std::uint64_t left = own.masks[i][bit / 64] & ~largest.masks[i][bit / 64];
      if ((left >> bit % 64 & 1) != 0) open.push_back(std::size_t{own.leaf[i]} * 512 + bit);
    }
  }
  const std::size_t inside = open.size();
  openvdb::math::CoordBBox around = voxelsWithin(solid, moved.body);
  around.expand(kBandReach);
  forEachVoxel(blocks, around, [&](std::size_t voxel, const openvdb::Coord&) {
    if (!blocks.isInside(voxel) && labels.fragment[voxel] == moved.from) open.push_back(voxel);
  });
  for (const std::size_t voxel : open) labels.fragment[voxel] = 0;
  const std::vector<std::size_t> given(open.begin(),
                                       open.begin() + static_cast<std::ptrdiff_t>(inside));
  for (const std::size_t voxel : spread(blocks, std::move(open), labels.fragment, progress)) {
    labels.fragment[voxel] = moved.from;
  }
  for (const std::size_t voxel : given) changed.insert(labels.fragment[voxel]);
}

// Gives the voxels of moved bodies to the fragments that have these now.  Returns whether any were.
bool follow(const Solid& solid, Labels& labels, const std::vector<MovedBody>& all,
            const Progress* progress) {
  Labels moved = labels;
  std::set<int> changed;
  for (const MovedBody& one : all) {
    const std::vector<std::size_t> voxels = lostVoxels(solid, moved, one);
    if (voxels.size() < kSmallComponentVoxels) continue;
    for (const std::size_t voxel : voxels) moved.fragment[voxel] = one.to;
    changed.insert({one.from, one.to});
    tidy(solid, moved, one, changed, progress);
  }
  if (changed.empty()) return false;
  const std::vector<FragmentMasks> masks = fragmentMasks(moved);
  const bool areWhole = std::all_of(changed.begin(), changed.end(), [&](int id) {
    const FragmentMasks& own = masks[static_cast<std::size_t>(id) - 1];
    return largestPart(own).voxels == voxelsOf(own.masks) && !own.masks.empty();
  });
  if (areWhole) labels = std::move(moved);
  return areWhole;
}

}  // namespace

ExactSurface settledExactMeshes(const Solid& solid, Labels& labels, const Labels* uneroded,
                                std::span<const LeafNeighbors> neighborhoods, double adaptivity,
                                const Progress* progress) {
  for (int round = 0;; ++round) {
    ExactSurface surface =
        exactMeshes(solid, labels, uneroded, neighborhoods, adaptivity, progress);
    const bool isFinal = !surface.failure.empty() || uneroded != nullptr || round == kMostRounds;
    if (isFinal || !follow(solid, labels, surface.moved, progress)) return surface;
  }
}

}  // namespace sherd
