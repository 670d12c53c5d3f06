// Points in the plane of a triangle, projected along a coordinate axis.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "intersect/triangle_point.h"

namespace sherd {

/// The points of a triangle, projected so that its corners are counter-clockwise.
class TrianglePlane {
 public:
  ///   points  the three corners, then others; not copied
  explicit TrianglePlane(std::span<const TrianglePoint> points);

  /// Returns true if the corners are on a line.
  [[nodiscard]] bool isFlat() const { return side_ == 0; }

  /// Returns 1 if three points are counter-clockwise, 0 if they are on a line; exact.
  [[nodiscard]] int orientation(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    if ((points_[a].edges & points_[b].edges & points_[c].edges) != 0) return 0;
    return side_ * sherd::orientation(points_[a].point, points_[b].point, points_[c].point, axis_);
  }

  /// Returns true if d is inside the circle of a, b, c, which are counter-clockwise, by more than
  /// rounding.
  [[nodiscard]] bool isInCircle(std::uint32_t a, std::uint32_t b, std::uint32_t c,
                                std::uint32_t d) const;

  /// Returns all points but the corners along a Morton curve.
  [[nodiscard]] std::vector<std::uint32_t> sorted() const;

 private:
  [[nodiscard]] glm::dvec2 at(std::uint32_t i) const {
    const glm::dvec3& p = points_[i].point.rounded;
    return {p[(axis_ + 1) % 3], p[(axis_ + 2) % 3]};
  }

  std::span<const TrianglePoint> points_;
  int axis_ = 0;  // that is left out
  int side_ = 0;  // 1 if the triangle is seen from its front
};

}  // namespace sherd
