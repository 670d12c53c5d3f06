// The points of a surface, any of which can be made without those before it.
#pragma once

#include <sherd/points.h>

#include <cstddef>
#include <cstdint>
#include <functional>

#include "mesh/surface_by_area.h"
#include "points/blocks.h"

namespace sherd {

/// A sampled point: a triangle, and a position in the unit square (see SurfaceTriangle::pointIn).
struct Draw {
  std::size_t triangle = 0;
  double u = 0.0, v = 0.0;
};

/// The points of a surface in their order.  Keeps a reference to the surface; holds 4 bytes a point
/// with PointSampler::poisson, 4 a point and 12 a triangle with PointRule::perTriangle (4 more a
/// triangle while it is made), else nothing.
class PointSequence {
 public:
  ///   options  checked by checkPointOptions; count > 0
  PointSequence(const SurfaceByArea& surface, const PointOptions& options);

  [[nodiscard]] std::size_t count() const { return count_; }

  /// Returns points first..end-1.
  [[nodiscard]] SurfacePoints points(std::size_t first, std::size_t end) const;

  /// Keeps a reference to this.
  [[nodiscard]] Blocks<SurfacePoints> blocks() const;

 private:
  const SurfaceByArea& surface_;
  std::size_t count_;
  std::function<Draw(std::size_t i)> draw_;
};

/// Returns the bytes that sampling one surface takes at most beside its triangles, blocks included.
[[nodiscard]] std::uint64_t samplingMemory(const PointOptions& options);

}  // namespace sherd
