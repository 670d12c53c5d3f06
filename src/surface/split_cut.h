// The cut between pieces that were split one after another: the planes of their splits.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "surface/site_cut.h"

namespace sherd {

/// The splits from which each fragment comes.
class SplitTree {
 public:
  SplitTree() = default;
  ///   cracks  see Labels, may be null
  explicit SplitTree(std::span<const Split> splits,
                     std::shared_ptr<const GivenCracks> cracks = nullptr);

  /// Whether no crack is a plane or given.
  bool empty() const;

  /// A plane, or a given crack, that bounds a fragment.
  struct Side {
    std::uint32_t split = 0;
    bool isAdded = false;  ///< the fragment is on the positive side

    bool operator==(const Side&) const = default;
  };

  /// Returns the side of the split that parted a fragment from another; null if none did, or by a
  /// crack of which only the labels are known.
  const Side* parted(std::uint16_t fragment, std::uint16_t other) const;

  /// Returns whether a side is that of a plane, else of a given crack.
  bool isPlane(const Side& side) const;

  /// Returns how far a voxel is beyond a side's plane, at most 0 for its own voxels: an integer,
  /// and by `distance` voxels.
  std::int64_t beyond(const Side& side, const openvdb::Coord& voxel) const;
  double distance(const Side& side, const openvdb::Coord& voxel) const;

  /// Returns the signed distance of a voxel to the given crack of a split, voxels; positive on the
  /// side of the added piece.
  double toGiven(std::uint32_t split, const openvdb::Coord& voxel) const;

 private:
  // Whether the surface of a split's crack is known.
  bool isKnown(const Split& split) const;

  std::vector<Split> splits_;
  std::shared_ptr<const GivenCracks> cracks_;
  std::vector<double> length_;            // [splits] of 64 normals
  std::vector<std::vector<Side>> sides_;  // [fragments + 1] from the first split on
};

/// As siteCut, by the planes of splits.  In a leaf a fragment is bounded by the planes that parted
/// it from the other fragments there.
[[nodiscard]] SiteCut splitCut(const CutHalo& halo, const openvdb::Coord& origin,
                               std::span<const std::uint16_t> fragments, const SplitTree& splits,
                               const VoxelBits& requested);

}  // namespace sherd
