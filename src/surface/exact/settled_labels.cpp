// Labels that agree with exact meshes.
#include "surface/exact/settled_labels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "base/union_find.h"
#include "mesh/search/triangle_tree.h"
#include "surface/exact/exact_meshes.h"
#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/leaves/spread.h"

namespace sherd {
namespace {

// How often the cut is made anew.
constexpr int kMostSettlings = 3;

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

// Labels that change where moved bodies' voxels go with them.
class Following {
 public:
  Following(const Solid& solid, Labels& labels, std::uint64_t least, const Progress* progress)
      : solid_(solid),
        blocks_(*labels.blocks),
        labels_(labels),
        least_(least),
        progress_(progress) {}

  // Gives a body's voxels to the fragment that has it now.  Returns whether it did: where a
  // fragment would fall apart or be too small, nothing changes.
  bool follow(const MovedBody& moved) {
    const std::vector<std::size_t> lost = lostVoxels(solid_, labels_, moved);
    if (lost.size() < kSmallComponentVoxels) return false;
    changed_.clear();
    std::vector<std::size_t>& left = voxelsOf(moved.from);
    const std::vector<std::size_t> before = left;
    for (const std::vector<std::size_t>& part : parts(lost)) {
      if (!isBeside(part, moved.to)) continue;  // tidy() gives it away
      for (const std::size_t voxel : part) set(voxel, moved.to);
    }
    tidy(moved, left);
    if (!left.empty() && left.size() >= least_ && areGainsConnected()) return true;
    for (auto at = changed_.rbegin(); at != changed_.rend(); ++at)
      labels_.fragment[at->first] = at->second;
    left = before;
    return false;
  }

 private:
  // Returns the inside voxels of a fragment, ascending.
  std::vector<std::size_t>& voxelsOf(std::uint16_t id) {
    const bool isNew = !voxels_.contains(id);
    std::vector<std::size_t>& own = voxels_[id];
    if (isNew) {
      blocks_.forEachInside([&](std::size_t voxel) {
        if (labels_.fragment[voxel] == id) own.push_back(voxel);
      });
    }
    return own;
  }

  // Whether some of these voxels touch an inside voxel of a fragment.
  //   except  ascending: of voxels that do not count
  bool isBeside(const std::vector<std::size_t>& voxels, std::uint16_t id,
                const std::vector<std::size_t>& except = {}) const {
    return std::any_of(voxels.begin(), voxels.end(), [&](std::size_t voxel) {
      for (std::size_t side = 0; side < 6; ++side) {
        const std::size_t beside = voxelBeside(blocks_, voxel, side);
        if (beside == kNoVoxel || !blocks_.isInside(beside)) continue;
        if (labels_.fragment[beside] != id) continue;
        if (!std::binary_search(except.begin(), except.end(), beside)) return true;
      }
      return false;
    });
  }

  void set(std::size_t voxel, std::uint16_t id) {
    changed_.emplace_back(voxel, labels_.fragment[voxel]);
    labels_.fragment[voxel] = id;
  }

  // Whether all that fragments got touches what they had.
  bool areGainsConnected() {
    std::map<std::uint16_t, std::vector<std::size_t>> gained, joined;
    for (const auto& [voxel, before] : changed_) {
      if (blocks_.isInside(voxel)) gained[labels_.fragment[voxel]].push_back(voxel);
    }
    for (auto& [id, own] : gained) {
      std::sort(own.begin(), own.end());
      own.erase(std::unique(own.begin(), own.end()), own.end());
      for (const std::vector<std::size_t>& part : parts(own)) {
        if (!isBeside(part, id, own)) return false;
      }
      if (const auto known = voxels_.find(id); known != voxels_.end()) {
        std::set_union(known->second.begin(), known->second.end(), own.begin(), own.end(),
                       std::back_inserter(joined[id]));
      }
    }
    for (auto& [id, all] : joined) voxels_[id] = std::move(all);
    return true;
  }

  // Returns the 6-connected parts of voxels, which are ascending, the largest first.
  std::vector<std::vector<std::size_t>> parts(const std::vector<std::size_t>& voxels) const {
    UnionFind sets(voxels.size());
    for (std::uint32_t i = 0; i < voxels.size(); ++i) {
      for (const std::size_t axis : {0u, 1u, 2u}) {
        const std::size_t behind = voxelBehind(blocks_, voxels[i], axis);
        if (behind == kNoVoxel) continue;
        const auto found = std::lower_bound(voxels.begin(), voxels.end(), behind);
        if (found == voxels.end() || *found != behind) continue;
        sets.unite(i, static_cast<std::uint32_t>(found - voxels.begin()));
      }
    }
    std::map<std::uint32_t, std::vector<std::size_t>> byName;
    const std::vector<std::uint32_t> names = std::move(sets).all();
    for (std::size_t i = 0; i < voxels.size(); ++i) byName[names[i]].push_back(voxels[i]);
    std::vector<std::vector<std::size_t>> all;
    for (auto& [name, own] : byName) all.push_back(std::move(own));
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    return all;
  }

  // Gives what a fragment has left beside its largest part, and its labels of the exterior band
  // near the voxels that it lost, to the fragments beside them: inside voxels first, and not by way
  // of the band, as they would not touch the fragment that they get.
  //   left  the fragment's voxels, changed
  void tidy(const MovedBody& moved, std::vector<std::size_t>& left) {
    std::erase_if(left, [&](std::size_t voxel) { return labels_.fragment[voxel] != moved.from; });
    std::vector<std::vector<std::size_t>> all = parts(left);
    std::vector<std::size_t> open, band;
    for (std::size_t i = 1; i < all.size(); ++i)
      open.insert(open.end(), all[i].begin(), all[i].end());
    left = all.empty() ? std::vector<std::size_t>() : std::move(all.front());
    openvdb::math::CoordBBox around = voxelsWithin(solid_, moved.body);
    around.expand(kBandReach);
    forEachVoxel(blocks_, around, [&](std::size_t voxel, const openvdb::Coord&) {
      if (!blocks_.isInside(voxel) && labels_.fragment[voxel] == moved.from) band.push_back(voxel);
    });
    for (const std::vector<std::size_t>* const voxels : {&open, &band}) {
      for (const std::size_t voxel : *voxels) set(voxel, 0);
    }
    giveAway(moved.from, std::move(open), SpreadFrom::inside);
    giveAway(moved.from, std::move(band), SpreadFrom::all);
  }

  // Gives voxels to the fragments beside them, and those that none reaches to one.
  void giveAway(std::uint16_t id, std::vector<std::size_t> voxels, SpreadFrom from) {
    for (const std::size_t voxel :
         spread(blocks_, std::move(voxels), labels_.fragment, progress_, from)) {
      labels_.fragment[voxel] = id;
    }
  }

  const Solid& solid_;
  const LeafBlocks& blocks_;
  Labels& labels_;
  const std::uint64_t least_;
  const Progress* const progress_;
  std::map<std::uint16_t, std::vector<std::size_t>> voxels_;    // of fragments that were asked for
  std::vector<std::pair<std::size_t, std::uint16_t>> changed_;  // with their labels before
};

// Gives the voxels of moved bodies to the fragments that have these now.  Returns whether any were.
bool follow(const Solid& solid, Labels& labels, std::uint64_t least,
            const std::vector<MovedBody>& all, const Progress* progress) {
  if (std::none_of(all.begin(), all.end(),
                   [&](const MovedBody& one) { return !lostVoxels(solid, labels, one).empty(); })) {
    return false;
  }
  Following following(solid, labels, least, progress);
  bool isAny = false;
  for (const MovedBody& one : all) {
    throwIfCancelled(progress);
    isAny = following.follow(one) || isAny;
  }
  return isAny;
}

}  // namespace

ExactSurface settledExactMeshes(const Solid& solid, Labels& labels, const Labels* uneroded,
                                std::uint64_t least, std::span<const LeafNeighbors> neighborhoods,
                                double adaptivity, const Progress* progress) {
  for (int round = 0;; ++round) {
    ExactSurface surface =
        exactMeshes(solid, labels, uneroded, neighborhoods, adaptivity, progress);
    const bool isFinal = !surface.failure.empty() || uneroded != nullptr || round == kMostSettlings;
    if (isFinal || !follow(solid, labels, least, surface.moved, progress)) return surface;
  }
}

}  // namespace sherd
