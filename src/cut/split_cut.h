// The cut between pieces that were split one after another: the cracks of their splits.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "cut/site_cut.h"
#include "voxelize/wall_middles.h"

namespace sherd {

/// The splits from which each fragment comes.
class SplitTree {
 public:
  SplitTree() = default;
  ///   cracks, walls  see Labels, may be null
  explicit SplitTree(std::span<const Split> splits,
                     std::shared_ptr<const GivenCracks> cracks = nullptr,
                     std::shared_ptr<const WallMiddles> walls = nullptr);

  /// Whether no crack is a plane, a sphere or given.
  bool empty() const;

  /// A crack that bounds a fragment.
  struct Side {
    std::uint32_t split = 0;
    bool isAdded = false;  ///< the fragment is on the positive side

    bool operator==(const Side&) const = default;
  };

  /// Returns the side of the split that parted a fragment from another; null if none did, or by a
  /// crack of which only the labels are known.
  const Side* parted(std::uint16_t fragment, std::uint16_t other) const;

  /// Returns whether a side is that of a given crack, else of a plane or sphere.
  bool isGiven(const Side& side) const;

  /// A voxel, and where its wall's middle is: WaysAround::middleAt.
  struct Position {
    openvdb::Coord voxel;
    glm::i64vec3 middle{0};
  };

  /// Returns the middle of walls, or null.
  const WallMiddles* walls() const { return walls_.get(); }

  /// Returns how far a voxel is beyond a side's plane or sphere, at most 0 for its own voxels: an
  /// integer, and by `distance` voxels.
  std::int64_t beyond(const Side& side, const Position& at) const;
  double distance(const Side& side, const Position& at) const;

  /// Returns the signed distance of a voxel to the given crack of a split, voxels; positive on the
  /// side of the added piece.
  ///   guess  as GivenCracks::distance
  double toGiven(std::uint32_t split, const openvdb::Coord& voxel, std::uint32_t& guess) const;

 private:
  // Whether the surface of a split's crack is known.
  bool isKnown(const Split& split) const;
  // By how much a position is beyond a plane or a sphere, above 0 on the positive side.
  static std::int64_t value(const Split& split, const Position& at);

  std::vector<Split> splits_;
  std::shared_ptr<const GivenCracks> cracks_;
  std::shared_ptr<const WallMiddles> walls_;
  std::vector<double> length_;            // [splits] of 64 normals; of spheres 64 radii
  std::vector<std::vector<Side>> sides_;  // [fragments + 1] from the first split on
};

/// As siteCut, by the cracks of splits.  In a leaf a fragment is bounded by the cracks that parted
/// it from the other fragments there.
[[nodiscard]] SiteCut splitCut(const CutHalo& halo, const openvdb::Coord& origin,
                               std::span<const std::uint16_t> fragments, const SplitTree& splits,
                               const VoxelBits& requested);

}  // namespace sherd
