// Intersection of a ray with voxels.
#include "seed/ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sherd {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// Returns the time at which the ray enters the box of voxels, if it does.
std::optional<double> entryTime(const VoxelBox& box, const glm::dvec3& origin,
                                const glm::dvec3& direction) {
  double enter = 0.0, leave = kNever;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis] - 0.5, high = box.max[axis] + 0.5;
    if (direction[axis] == 0.0) {
      if (origin[axis] < low || origin[axis] > high) return {};
      continue;
    }
    const double toLow = (low - origin[axis]) / direction[axis];
    const double toHigh = (high - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(toLow, toHigh));
    leave = std::min(leave, std::max(toLow, toHigh));
  }
  if (enter > leave) return {};
  return enter;
}

}  // namespace

std::optional<openvdb::Coord> firstVoxelOnRay(const VoxelIndex& voxels, const VoxelBox& box,
                                              const glm::dvec3& origin,
                                              const glm::dvec3& givenDirection) {
  // The longest component becomes 1, so that no time overflows.
  const glm::dvec3 direction =
      givenDirection / std::max({std::abs(givenDirection.x), std::abs(givenDirection.y),
                                 std::abs(givenDirection.z)});
  const std::optional<double> enter = entryTime(box, origin, direction);
  if (!enter) return {};
  openvdb::Coord voxel;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = std::floor(origin[axis] + *enter * direction[axis] + 0.5);
    voxel[axis] = static_cast<int>(
        std::clamp(at, static_cast<double>(box.min[axis]), static_cast<double>(box.max[axis])));
  }
  while (true) {
    if (voxels.find(voxel)) return voxel;
    // Times are recomputed at each wall: a sum would drift.
    int next = 0;
    double soonest = kNever;
    for (int axis = 0; axis < 3; ++axis) {
      if (direction[axis] == 0.0) continue;
      const double wall = voxel[axis] + (direction[axis] > 0.0 ? 0.5 : -0.5);
      const double time = (wall - origin[axis]) / direction[axis];
      if (time >= soonest) continue;
      soonest = time;
      next = axis;
    }
    voxel[next] += direction[next] > 0.0 ? 1 : -1;
    if (voxel[next] < box.min[next] || voxel[next] > box.max[next]) return {};
  }
}

}  // namespace sherd
