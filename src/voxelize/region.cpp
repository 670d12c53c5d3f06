// What a solid was made from: decides about points of space, whatever the voxels.
#include "voxelize/region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "mesh/search/nearest_on_triangle.h"
#include "voxelize/distance.h"

namespace sherd {

bool SolidRegion::isWithin(const IndexPoint& point, double reach) const {
  const double distance = surface_->nearest(point, halfThickness_ + reach).distance;
  return std::abs(distance - halfThickness_) < reach;
}

bool SolidRegion::isAtClosedHole(const IndexPoint& point) const {
  if (firstClosing_ == TriangleTree::kNone) return false;
  const TriangleTree::Nearest nearest =
      surface_->nearest(point, std::numeric_limits<double>::infinity());
  return nearest.triangle != TriangleTree::kNone &&
         surface_->source(nearest.triangle) >= firstClosing_;
}

IndexPoint SolidRegion::onSurface(const IndexPoint& anywhere) const {
  constexpr double kFar = 1e9;  // voxels; squares of more could overflow
  const glm::dvec3 point = glm::clamp(anywhere, -kFar, kFar);
  const TriangleTree::Nearest nearest =
      surface_->nearest(point, std::numeric_limits<double>::infinity());
  if (nearest.triangle == TriangleTree::kNone) return point;
  const std::array<glm::dvec3, 3> t = surface_->corners(nearest.triangle);
  const glm::dvec3 on = nearestOnTriangle(point, t[0], t[1], t[2]);
  const double apart = glm::length(point - on);
  if (halfThickness_ == 0.0 || apart == 0.0) return on;
  return on + halfThickness_ / apart * (point - on);
}

std::optional<IndexPoint> SolidRegion::firstHit(const IndexPoint& origin,
                                                const glm::dvec3& direction) const {
  // The longest component becomes 1, so that nothing overflows.
  const glm::dvec3 along =
      direction / std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  const double at = surface_->firstHit(origin, along, 0.0);
  if (!std::isfinite(at)) return {};
  return origin + at * along;
}

std::shared_ptr<const SolidRegion> regionOf(const Solid& solid, TriangleMesh surface) {
  for (glm::dvec3& v : surface.vertices) v = solid.frame.indexFromWorld(v);
  const openvdb::Coord dims = solid.box.dims();
  return std::make_shared<const SolidRegion>(
      glm::dvec3(dims.x(), dims.y(), dims.z()), std::make_shared<const TriangleTree>(surface),
      [distanceAt = samplesOf(solid.distance)](const glm::dvec3& at) {
        return distanceAt(at) < 0.0f;
      },
      0.0, true);
}

}  // namespace sherd
