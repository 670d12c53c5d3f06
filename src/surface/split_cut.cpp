// Sides of planes are decided in integers, as by growth.
#include "surface/split_cut.h"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <utility>

#include "grow/guide_sides.h"
#include "surface/halo_bits.h"

namespace sherd {

SplitTree::SplitTree(std::span<const Split> splits, std::shared_ptr<const GivenCracks> cracks)
    : splits_(splits.begin(), splits.end()), cracks_(std::move(cracks)) {
  for (std::uint32_t i = 0; i < splits_.size(); ++i) {
    const Split& split = splits_[i];
    length_.push_back(64.0 * glm::length(glm::dvec3(split.normal)));
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
  return split.normal != glm::ivec3(0) || cracks_ != nullptr;
}

const SplitTree::Side* SplitTree::parted(std::uint16_t fragment, std::uint16_t other) const {
  if (std::max(fragment, other) >= sides_.size()) return nullptr;
  const std::vector<Side>&a = sides_[fragment], &b = sides_[other];
  const auto [own, others] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  const bool isParted = own != a.end() && others != b.end() && own->split == others->split;
  return isParted && isKnown(splits_[own->split]) ? &*own : nullptr;
}

std::int64_t SplitTree::beyond(const Side& side, const openvdb::Coord& voxel) const {
  const Split& split = splits_[side.split];
  if (split.normal == glm::ivec3(0)) {
    const bool isPositive = cracks_->distance(static_cast<std::size_t>(split.offset), voxel) > 0.0;
    return isPositive == side.isAdded ? 0 : 1;
  }
  std::int64_t value = -split.offset;
  for (int i = 0; i < 3; ++i) value += 64 * std::int64_t{split.normal[i]} * voxel[i];
  return side.isAdded ? 1 - value : value;  // voxels on the plane are on the negative side
}

double SplitTree::distance(const Side& side, const openvdb::Coord& voxel) const {
  const Split& split = splits_[side.split];
  if (split.normal == glm::ivec3(0)) {
    const double distance = cracks_->distance(static_cast<std::size_t>(split.offset), voxel);
    return side.isAdded ? -distance : distance;
  }
  const std::int64_t value = beyond(side, voxel) - (side.isAdded ? 1 : 0);
  return static_cast<double>(value) / length_[side.split];
}

namespace {

// The planes that bound a fragment in a leaf, each once.
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

}  // namespace

SiteCut splitCut(const CutHalo& halo, const openvdb::Coord& origin,
                 std::span<const std::uint16_t> fragments, const SplitTree& splits,
                 const VoxelBits& requested) {
  SiteCut cut;
  cut.distance.assign(fragments.size() * 512, 3.0f);
  const std::vector<Bounds> bounds = boundsOf(fragments, splits);
  HaloBits own{}, mismatches{};
  for (std::size_t row = 0; row < 64; ++row) {
    own[haloRow(row)] = static_cast<std::uint16_t>(requested[row] << kCutHalo);
  }
  const HaloBits tested = dilated(own);
  const auto voxelAt = [&](std::size_t row, std::size_t z) {
    return origin +
           openvdb::Coord(static_cast<int>(row / kCutSide), static_cast<int>(row % kCutSide),
                          static_cast<int>(z)) -
           openvdb::Coord(kCutHalo);
  };
  const auto agrees = [&](std::uint16_t label, const openvdb::Coord& voxel) {
    const auto at = std::lower_bound(fragments.begin(), fragments.end(), label);
    if (at == fragments.end() || *at != label || label == Labels::kEroded) return false;
    const Bounds& of = bounds[static_cast<std::size_t>(at - fragments.begin())];
    return of.isAny && std::all_of(of.sides.begin(), of.sides.end(), [&](const auto& side) {
             return splits.beyond(side, voxel) <= 0;
           });
  };
  for (std::size_t row = 0; row < tested.size(); ++row) {
    for (unsigned bits = tested[row]; bits != 0; bits &= bits - 1) {
      const auto z = static_cast<std::size_t>(std::countr_zero(bits));
      const std::uint16_t label = halo[row * kCutSide + z];
      if (label != 0 && !agrees(label, voxelAt(row, z))) {
        mismatches[row] |= static_cast<std::uint16_t>(1u << z);
      }
    }
    for (unsigned bits = own[row]; bits != 0; bits &= bits - 1) {
      const auto z = static_cast<std::size_t>(std::countr_zero(bits));
      const std::size_t v =
          (row / kCutSide - kCutHalo) * 64 + (row % kCutSide - kCutHalo) * 8 + z - kCutHalo;
      for (std::size_t k = 0; k < fragments.size(); ++k) {
        if (bounds[k].sides.empty()) continue;
        double d = -3.0;
        for (const SplitTree::Side& side : bounds[k].sides) {
          d = std::max(d, splits.distance(side, voxelAt(row, z)));
        }
        cut.distance[k * 512 + v] = static_cast<float>(std::min(d, 3.0));
      }
    }
  }
  const HaloBits fails = dilated(mismatches);
  for (std::size_t row = 0; row < 64; ++row) {
    cut.holds[row] = static_cast<std::uint8_t>(requested[row] & ~(fails[haloRow(row)] >> kCutHalo));
  }
  return cut;
}

}  // namespace sherd
