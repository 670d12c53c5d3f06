// The constrained triangulation of one triangle.
#pragma once

#include <sherd/progress.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "intersect/triangle_point.h"

namespace sherd {

struct Triangulation {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  std::vector<glm::uvec3> triangles;  ///< oriented like the whole triangle, exactly
  std::vector<glm::uvec3> segments;   ///< [triangles] the segment from corner k to the next, or
                                      ///< kNone

  // What was left out; all empty if all points and segments are in the triangulation.
  std::vector<std::array<std::uint32_t, 2>> crossing;    ///< segments that cross or overlap
  std::vector<std::array<std::uint32_t, 2>> onSegment;   ///< {point, segment} that it is inside of
  std::vector<std::array<std::uint32_t, 2>> coincident;  ///< points
  bool isFlat = false;  ///< the corners are on a line; there are no triangles then

  [[nodiscard]] bool isComplete() const {
    return crossing.empty() && onSegment.empty() && coincident.empty() && !isFlat;
  }
};

/// Triangulates a triangle so that segments are edges.  All decisions on positions are exact; the
/// triangles are nearly Delaunay in the projection along the triangle's largest normal component.
/// Of two segments that cross the later is left out.
///   points    the three corners, counter-clockwise, then others in the triangle
///   segments  pairs of points
///   progress  may be null
///   throws    Error(cancelled)
///   cost      about points * log(points), for sorting
///   source    Lawson, Software for C1 Surface Interpolation, 1977; Sloan, A Fast Algorithm for
///             Generating Constrained Delaunay Triangulations, 1993
[[nodiscard]] Triangulation triangulate(std::span<const TrianglePoint> points,
                                        std::span<const std::array<std::uint32_t, 2>> segments,
                                        const Progress* progress = nullptr);

}  // namespace sherd
