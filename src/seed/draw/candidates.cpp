// The voxels that seeds may take, and the points of space that choose them.
#include "seed/draw/candidates.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "voxelize/distance.h"
#include "voxelize/fill/fill.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

constexpr double kStepsInSpace = 1 << 20;  // of the box's longest side

glm::i64vec3 rounded(const glm::dvec3& v) {
  return {std::llround(v.x), std::llround(v.y), std::llround(v.z)};
}

}  // namespace

Candidates::Candidates(const Solid& solid, const VoxelIndex& voxels, SeedsOn on, double thin)
    : solid_(solid), voxels_(voxels), on_(on), thin_(thin) {
  if (on == SeedsOn::wall) walls_.emplace(solid);
  if (solid.region) {
    low_ = glm::dvec3(-0.5);
    sides_ = solid.region->sides();
    distanceAt_ = valuesOf(solid.distance);
  } else {
    const openvdb::Coord dims = solid.box.dims();
    low_ = centerOf(solid.box.min) - 0.5;
    sides_ = {dims.x(), dims.y(), dims.z()};
  }
  longest_ = std::max({sides_.x, sides_.y, sides_.z});
}

std::uint64_t Candidates::drawsForOne() const {
  const double expected = std::max(sides_.x, 1.0) * std::max(sides_.y, 1.0) *
                          std::max(sides_.z, 1.0) /
                          static_cast<double>(std::max<std::uint64_t>(voxels_.total(), 1));
  return static_cast<std::uint64_t>(std::clamp(64.0 * expected, 64.0, 4096.0));
}

glm::i64vec3 Candidates::stepsOfBox() const { return rounded(sides_ / longest_ * kStepsInSpace); }

// Where the voxel around the point is far from the surface, its distance decides; else the mesh.
bool Candidates::isSolid(const glm::dvec3& point) const {
  const openvdb::Coord voxel = nearestVoxel(point);
  if (!distanceAt_) return voxels_.find(voxel).has_value();
  const SolidRegion& region = *solid_.region;
  if (!region.isAsVoxels()) return region.contains(point);
  constexpr double kSure = 1.5;  // voxels: a voxel's corner is 0.87 away, the rest is for rounding
  const double distance = distanceAt_(voxel) / solid_.frame.voxelSize;
  if (distance > kSure) return false;
  const bool isDeep = distance < -kSure;
  if (on_ == SeedsOn::surface) {
    const double layer = kSurfaceLayer * longest_;
    const bool isInBand = distance > -(kHalfWidthVoxels - 0.01);
    if (isDeep && isInBand && distance < -(layer + kSure)) return false;
    if (!region.isWithin(point, layer)) return false;
  }
  return isDeep || region.contains(point);
}

std::optional<Candidate> Candidates::near(const glm::dvec3& point,
                                          const glm::i64vec3& inSpace) const {
  if (!isSolid(point)) return {};
  const bool moves = distanceAt_ && (on_ == SeedsOn::surface || !solid_.region->isAsVoxels());
  glm::dvec3 at = moves ? solid_.region->onSurface(point) : point;
  if (walls_ && !moves) at = wallMiddle(*walls_, point, thin_);
  // A point that is inside the mesh may lie in a voxel whose center is not.
  constexpr double kFarthest = 2.0;
  Candidate found{voxels_.nearestWithin(at, kFarthest), {}, inSpace};
  if (at != point && walls_) found.inSpace = rounded((at - low_) / longest_ * kStepsInSpace);
  if (found.key) found.shift = shiftOf(at, voxels_.voxelAt(*found.key));
  return found;
}

std::optional<Candidate> Candidates::inBox(const glm::dvec3& unit) const {
  return near(pointInBox(unit), rounded(unit * (sides_ / longest_) * kStepsInSpace));
}

std::optional<Candidate> Candidates::at(const glm::dvec3& point) const {
  const glm::dvec3 fromLow = point - low_;
  if (!(std::min({fromLow.x, fromLow.y, fromLow.z}) >= -1.0 &&
        std::max({fromLow.x, fromLow.y, fromLow.z}) <= longest_ + 1.0)) {
    return {};
  }
  return near(point, rounded((point - low_) / longest_ * kStepsInSpace));
}

Candidate Candidates::ofVoxel(VoxelKey key) const {
  return {key, glm::ivec3(0),
          rounded((centerOf(voxels_.voxelAt(key)) - low_) / longest_ * kStepsInSpace)};
}

glm::ivec3 shiftOf(const glm::dvec3& point, const openvdb::Coord& voxel) {
  const glm::dvec3 steps = (point - centerOf(voxel)) * static_cast<double>(kSeedSteps);
  return glm::ivec3(glm::clamp(glm::floor(steps + 0.5), -1.0 * kMostShift, 1.0 * kMostShift));
}

}  // namespace sherd
