// The cut between Voronoi cells: planes half way between seeds.
#pragma once

#include <sherd/labels.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "surface/leaf_labels.h"

namespace sherd {

constexpr int kCutHalo = 2;  ///< voxels round a leaf that its cut depends on
constexpr int kCutSide = 8 + 2 * kCutHalo;

/// Labels of a leaf and of what lies round it, z fastest.
using CutHalo = LabelCube<kCutSide>;

/// Seeds by fragment, to measure distances from.
class Sites {
 public:
  explicit Sites(const VoronoiSites& sites);

  bool empty() const { return first_.empty(); }

  /// A voxel or seed (or a step between two) under the grain, in units of its metric.
  glm::i64vec3 stretched(const openvdb::Coord& voxel) const;

  /// A seed, as a voxel and stretched.
  struct Site {
    glm::i64vec3 stretched{0};
    glm::dvec3 voxel{0.0};
  };

  /// The sites of a fragment; none where it has none.
  std::span<const Site> of(std::uint16_t fragment) const;

  /// How fast, per voxel, the difference of the squared distances to two stretched sites grows
  /// towards one of them.
  double slope(const glm::i64vec3& a, const glm::i64vec3& b) const;

 private:
  std::array<std::int64_t, 9> rows_{};
  std::vector<std::uint32_t> first_;  // [ids+2] into sites_, or empty
  std::vector<Site> sites_;
};

/// A bit for each voxel of a leaf: [x*8+y] bit z.
using VoxelBits = std::array<std::uint8_t, 64>;

/// A leaf's cut where its labels are those of the nearest sites.
struct SiteCut {
  VoxelBits holds{};  ///< of the wanted voxels: all inside voxels up to two away belong to
                      ///< their nearest site
  std::vector<float> distance;  ///< [fragments*512] voxels to the plane, within -3..3; 3 where none
                                ///< is wanted
};

/// What was computed for a cut, to show that cost is linear.
struct SiteCutWork {
  std::uint64_t distances = 0;  ///< asked for: voxels times fragments
  std::uint64_t planes = 0;     ///< that were evaluated for them
};

/// Distances to the planes that bound each fragment's cell: to the nearest of them inside it, and
/// outside to the one that is passed by most.  Only the planes near a site decide (see
/// SitesOfLeaf::toCut), so a leaf of many small cells costs in proportion to their number.
///   halo       labels of inside voxels, else 0
///   origin     the leaf's lowest voxel
///   fragments  [n] whose cut is asked for
///   wanted     where it is asked for
///   work       counts are added to it, where it is given
[[nodiscard]] SiteCut siteCut(const CutHalo& halo, const openvdb::Coord& origin,
                              std::span<const std::uint16_t> fragments, const Sites& sites,
                              const VoxelBits& wanted, SiteCutWork* work = nullptr);

}  // namespace sherd
