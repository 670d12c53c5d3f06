// Sides of planes are decided in integers, as by growth.
#include "cut/split_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <utility>

#include "cut/cut_of_leaf.h"
#include "grow/splits/guide_sides.h"

namespace sherd {

SplitTree::SplitTree(std::span<const Split> splits, std::shared_ptr<const GivenCracks> cracks,
                     std::shared_ptr<const WallMiddles> walls)
    : splits_(splits.begin(), splits.end()), cracks_(std::move(cracks)), walls_(std::move(walls)) {
  for (std::uint32_t i = 0; i < splits_.size(); ++i) {
    const Split& split = splits_[i];
    length_.push_back(split.isSphere ? 64.0 * std::sqrt(static_cast<double>(split.offset))
                                     : 64.0 * glm::length(glm::dvec3(split.normal)));
    sides_.resize(std::max<std::size_t>(sides_.size(), std::max(split.fragment, split.added) + 1u));
    sides_[split.added] = sides_[split.fragment];
    sides_[split.added].push_back({i, true});
    sides_[split.fragment].push_back({i, false});
  }
}

bool SplitTree::empty() const {
  return std::none_of(splits_.begin(), splits_.end(),
                      [this](const Split& split) { return isKnown(split); });
}

bool SplitTree::isKnown(const Split& split) const {
  return split.isSphere || split.normal != glm::ivec3(0) || cracks_ != nullptr;
}

const SplitTree::Side* SplitTree::parted(std::uint16_t fragment, std::uint16_t other) const {
  if (std::max(fragment, other) >= sides_.size()) return nullptr;
  const std::vector<Side>&a = sides_[fragment], &b = sides_[other];
  const auto [own, others] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  const bool isParted = own != a.end() && others != b.end() && own->split == others->split;
  return isParted && isKnown(splits_[own->split]) ? &*own : nullptr;
}

bool SplitTree::isGiven(const Side& side) const {
  const Split& split = splits_[side.split];
  return !split.isSphere && split.normal == glm::ivec3(0);
}

std::int64_t SplitTree::value(const Split& split, const Position& at) {
  std::int64_t value = -split.offset;
  const bool ignoresWalls = !split.isSphere && split.center != glm::ivec3(0);
  for (int i = 0; i < 3; ++i) {
    const std::int64_t own = ignoresWalls ? 64 * std::int64_t{at.voxel[i]} : at.middle[i];
    const std::int64_t from = own - split.center[i];
    value += split.isSphere ? from * from : std::int64_t{split.normal[i]} * own;
  }
  return value;
}

std::int64_t SplitTree::beyond(const Side& side, const Position& at) const {
  const std::int64_t beyond = value(splits_[side.split], at);
  return side.isAdded ? 1 - beyond : beyond;  // voxels on the crack are on the negative side
}

double SplitTree::distance(const Side& side, const Position& at) const {
  const Split& split = splits_[side.split];
  const std::int64_t whole = value(split, at);
  const auto signedValue = static_cast<double>(side.isAdded ? -whole : whole);
  if (!split.isSphere) return signedValue / length_[side.split];
  // |p| - r as (p^2 - r^2) / (|p| + r), which cancels less.
  const double radius = length_[side.split] / 64.0;
  const double from = std::sqrt(std::max(static_cast<double>(whole) + radius * radius, 0.0));
  return signedValue / (from + radius) / 64.0;
}

double SplitTree::toGiven(std::uint32_t split, const openvdb::Coord& voxel,
                          std::uint32_t& guess) const {
  return cracks_->distance(static_cast<std::size_t>(splits_[split].offset), voxel, guess);
}

namespace {

// The cracks that bound a fragment in a leaf, each once.
struct Bounds {
  std::vector<SplitTree::Side> sides{};
  bool isAny = true;  // false: no split parted it from some other fragment
};

std::vector<Bounds> boundsOf(std::span<const std::uint16_t> fragments, const SplitTree& splits) {
  std::vector<Bounds> all(fragments.size());
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    for (const std::uint16_t other : fragments) {
      if (other == fragments[i] || other == Labels::kEroded) continue;
      const SplitTree::Side* const side = splits.parted(fragments[i], other);
      std::vector<SplitTree::Side>& sides = all[i].sides;
      if (side == nullptr) {
        all[i].isAny = false;
      } else if (std::find(sides.begin(), sides.end(), *side) == sides.end()) {
        sides.push_back(*side);
      }
    }
  }
  return all;
}

// Bounds the fragments of one leaf by the surfaces of splits, row by row of its halo.
class SidesOfLeaf {
 public:
  SidesOfLeaf(const openvdb::Coord& origin, std::span<const std::uint16_t> fragments,
              const SplitTree& splits)
      : fragments_(fragments),
        splits_(splits),
        low_(origin - openvdb::Coord(kCutHalo)),
        bounds_(boundsOf(fragments, splits)),
        ways_(splits.walls(), origin) {
    for (const Bounds& bounds : bounds_) {
      for (const SplitTree::Side& side : bounds.sides) {
        if (splits.isGiven(side)) given_.try_emplace(side.split);
      }
    }
  }

  void setRow(std::size_t x, std::size_t y, const std::array<std::size_t, 2>&) {
    row_ = low_ + openvdb::Coord(static_cast<int>(x), static_cast<int>(y), 0);
    z_ = kCutSide;  // of no voxel
    for (auto& [split, given] : given_) given.distances.fill(std::nullopt);
  }

  bool agrees(std::uint16_t label, std::size_t z) {
    const auto at = std::lower_bound(fragments_.begin(), fragments_.end(), label);
    if (at == fragments_.end() || *at != label || label == Labels::kEroded) return false;
    const Bounds& of = bounds_[static_cast<std::size_t>(at - fragments_.begin())];
    return of.isAny && std::all_of(of.sides.begin(), of.sides.end(),
                                   [&](const SplitTree::Side& side) { return isWithin(side, z); });
  }

  bool hasCut(std::size_t k) const { return !bounds_[k].sides.empty(); }

  float toCut(std::size_t k, std::size_t z) {
    double d = -3.0;
    for (const SplitTree::Side& side : bounds_[k].sides) d = std::max(d, distance(side, z));
    return static_cast<float>(std::min(d, 3.0));
  }

 private:
  openvdb::Coord voxel(std::size_t z) const {
    return row_ + openvdb::Coord(0, 0, static_cast<int>(z));
  }

  // Asked for several sides of one voxel.
  const SplitTree::Position& position(std::size_t z) {
    if (z != z_) {
      z_ = z;
      position_ = {voxel(z), ways_.middleAt(voxel(z))};
    }
    return position_;
  }

  // The signed distance to a given crack, which takes a search: once for each voxel.
  double toGiven(std::uint32_t split, std::size_t z) {
    Given& given = given_.find(split)->second;
    std::optional<double>& known = given.distances[z];
    if (!known) known = splits_.toGiven(split, voxel(z), given.guess);
    return *known;
  }

  bool isWithin(const SplitTree::Side& side, std::size_t z) {
    if (!splits_.isGiven(side)) return splits_.beyond(side, position(z)) <= 0;
    return (toGiven(side.split, z) > 0.0) == side.isAdded;
  }

  double distance(const SplitTree::Side& side, std::size_t z) {
    if (!splits_.isGiven(side)) return splits_.distance(side, position(z));
    const double distance = toGiven(side.split, z);
    return side.isAdded ? -distance : distance;
  }

  std::span<const std::uint16_t> fragments_;
  const SplitTree& splits_;
  openvdb::Coord low_, row_;
  std::vector<Bounds> bounds_;  // [fragments]
  WaysAround ways_;
  std::size_t z_ = kCutSide;
  SplitTree::Position position_{};  // at z_
  struct Given {
    std::array<std::optional<double>, kCutSide> distances{};  // of the row's voxels
    std::uint32_t guess = TriangleTree::kNone;
  };
  std::map<std::uint32_t, Given> given_;  // by split
};

}  // namespace

SiteCut splitCut(const CutHalo& halo, const openvdb::Coord& origin,
                 std::span<const std::uint16_t> fragments, const SplitTree& splits,
                 const VoxelBits& requested) {
  SidesOfLeaf ofLeaf(origin, fragments, splits);
  return cutOfLeaf(halo, fragments.size(), requested, ofLeaf);
}

}  // namespace sherd
