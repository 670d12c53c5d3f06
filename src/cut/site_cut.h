// The cut between Voronoi cells, or power cells where seeds have weights: planes between seeds.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "cut/leaf_cut.h"
#include "voxel_metric.h"
#include "voxelize/wall_middles.h"

namespace sherd {

/// The seeds of each fragment, in the metric of growth.
class Sites {
 public:
  ///   walls  see Labels, may be null
  explicit Sites(const VoronoiSites& sites, std::shared_ptr<const WallMiddles> walls = nullptr);

  bool empty() const { return first_.empty(); }

  /// Returns a position or difference of voxels, transformed by the anisotropy, in steps of seeds.
  glm::i64vec3 stretched(const openvdb::Coord& voxel) const;
  /// The same of a position in steps of seeds.
  glm::i64vec3 stretchedSteps(const glm::i64vec3& steps) const;

  /// Returns the middle of walls, or null.
  const WallMiddles* walls() const { return walls_.get(); }

  /// A seed.
  struct Site {
    glm::i64vec3 stretched{0};
    glm::dvec3 point{0.0};    ///< index space
    std::int64_t weight = 0;  ///< in the unit of squared stretched distances
  };

  /// Returns the sites of a fragment, possibly none.
  std::span<const Site> of(std::uint16_t fragment) const;

  /// Returns the gradient's length, per voxel, of the difference of squared distances to two
  /// stretched sites.
  double slope(const glm::i64vec3& a, const glm::i64vec3& b) const;

 private:
  sherd_metric metric_{};
  std::vector<std::uint32_t> first_;  // [ids+2] into sites_, or empty
  std::vector<Site> sites_;
  std::shared_ptr<const WallMiddles> walls_;
};

/// Operation counts, to test that the cost is linear.
struct SiteCutWork {
  std::uint64_t distances = 0;  ///< requested: voxels times fragments
  std::uint64_t planes = 0;     ///< evaluated for them
};

/// Returns distances to the planes that bound each fragment's cell: inside it to the nearest plane,
/// outside to the plane that the voxel is farthest beyond.  Only planes near a site matter (see
/// SitesOfLeaf::toCut), so the cost of a leaf of many small cells is linear in their number.  In
/// thin walls distances are those of the middle of the wall at a voxel, see Labels::walls.
///   halo       labels of inside voxels, else 0
///   origin     the leaf's lowest voxel
///   fragments  [n] ascending, to compute distances for
///   requested  voxels to compute
///   work       null, or counts to add to
[[nodiscard]] SiteCut siteCut(const CutHalo& halo, const openvdb::Coord& origin,
                              std::span<const std::uint16_t> fragments, const Sites& sites,
                              const VoxelBits& requested, SiteCutWork* work = nullptr);

}  // namespace sherd
