// Distances between voxels.
#pragma once

#include <sherd/grid_fwd.h>

#include <algorithm>
#include <cstdint>

namespace sherd {

enum class Metric {
  euclidean,  ///< sqrt(dx^2 + dy^2 + dz^2)
  chebyshev,  ///< max(|dx|, |dy|, |dz|)
  manhattan,  ///< |dx| + |dy| + |dz|
};

/// Returns an integer that orders voxel offsets by distance: the distance in voxels, squared for
/// the Euclidean metric.
constexpr std::int64_t metricOrder(Metric metric, std::int64_t dx, std::int64_t dy,
                                   std::int64_t dz) {
  dx = dx < 0 ? -dx : dx;
  dy = dy < 0 ? -dy : dy;
  dz = dz < 0 ? -dz : dz;
  switch (metric) {
    case Metric::euclidean:
      return dx * dx + dy * dy + dz * dz;
    case Metric::chebyshev:
      return std::max({dx, dy, dz});
    case Metric::manhattan:
      return dx + dy + dz;
  }
  return 0;
}

inline std::int64_t metricOrder(Metric metric, const openvdb::Coord& a, const openvdb::Coord& b) {
  return metricOrder(metric, std::int64_t{a.x()} - b.x(), std::int64_t{a.y()} - b.y(),
                     std::int64_t{a.z()} - b.z());
}

}  // namespace sherd
