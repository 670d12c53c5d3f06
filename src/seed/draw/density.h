// Where pieces are small: densities in space.
#pragma once

#include <sherd/mesh.h>
#include <sherd/seeds.h>

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "base/random.h"
#include "seed/draw/voxel_index.h"

namespace sherd {

/// The number of pieces per volume at each point, up to a factor.  Thread-safe.
class DensityField {
 public:
  ///   at    of a point, 0..most
  ///   most  above 0, finite
  DensityField(std::function<double(const WorldPoint&)> at, double most)
      : at_(std::move(at)), most_(most) {}

  [[nodiscard]] double at(const WorldPoint& p) const { return at_(p); }

  /// Returns an upper bound of `at`.
  [[nodiscard]] double most() const { return most_; }

 private:
  std::function<double(const WorldPoint&)> at_;
  double most_;
};

/// Returns the density whose value at a point is that of the closest point of a surface, between
/// whose vertices it is linear.
///   values  [vertices] of a mesh with one triangle or more
///   throws  Error(input) a value that is negative or not finite; all are 0
[[nodiscard]] std::shared_ptr<const DensityField> surfaceDensity(const TriangleMesh& mesh,
                                                                 std::span<const float> values);

/// Returns the density of a grid with any affine transform, linear between its voxels.
///   throws  Error(input) a value that is negative or not finite, also of inactive voxels and the
///           background; all are 0; Error(cancelled)
[[nodiscard]] std::shared_ptr<const DensityField> gridDensity(
    std::shared_ptr<const openvdb::FloatGrid> grid, const Progress* progress = nullptr);

/// Accepts random points with a probability proportional to a density.
class DensityTest {
 public:
  ///   field  null: all points are accepted; kept by reference, as is `frame`
  DensityTest(const DensityField* field, const GridFrame& frame, std::uint64_t seed)
      : field_(field), frame_(frame), seed_(seed) {}

  [[nodiscard]] bool hasField() const { return field_ != nullptr; }

  /// Returns the density, as a share of the largest.
  [[nodiscard]] double at(const IndexPoint& point) const {
    return field_ == nullptr ? 1.0 : field_->at(frame_.worldFromIndex(point)) / field_->most();
  }

  ///   item  number of the draw
  [[nodiscard]] bool accepts(const IndexPoint& point, std::uint64_t item) const {
    return field_ == nullptr || randomUnit(seed_, Stage::seedDensity, item) < at(point);
  }

 private:
  const DensityField* field_;
  const GridFrame& frame_;
  std::uint64_t seed_;
};

/// Voxels with a probability proportional to the density at their centers, for when draws of points
/// have not met enough.
class DenseVoxels {
 public:
  ///   throws  Error(cancelled)
  DenseVoxels(const VoxelIndex& voxels, const DensityTest& density, const Progress* progress);

  /// Returns a free voxel with a density above 0; the first free one after the voxel drawn, if that
  /// is taken.
  ///   unit    random number in [0, 1)
  ///   throws  Error(usage) there is none; Error(cancelled)
  [[nodiscard]] VoxelKey draw(double unit, const std::function<bool(VoxelKey)>& isFree) const;

 private:
  [[nodiscard]] double at(std::uint64_t number) const {
    return density_.at(centerOf(voxels_.voxelAt(voxels_.at(number))));
  }

  const VoxelIndex& voxels_;
  const DensityTest& density_;
  const Progress* progress_;
  std::vector<double> before_;  // [blocks + 1] sum of the densities before a block of voxels
};

}  // namespace sherd
