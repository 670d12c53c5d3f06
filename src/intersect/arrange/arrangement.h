// The arrangement of a mesh with itself.
#pragma once

#include <sherd/progress.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "intersect/arrange/point_set.h"

namespace sherd {

/// In Progress::report.
inline constexpr const char* kUniteStage = "unite";

/// A part of a plane that triangles of the mesh cover: whole triangles or parts of them, which no
/// other triangle crosses.
struct ArrangedTriangle {
  glm::uvec3 corner{0};            ///< numbers of points
  std::uint32_t source = 0;        ///< the first triangle that covers it and is oriented like it
  std::uint32_t multiplicity = 1;  ///< triangles that cover it and are oriented like it, minus
                                   ///< those that are oriented the other way; never 0
};

/// A line in a plane, between two points.
struct ArrangedLine {
  std::uint32_t from = 0, to = 0;  ///< numbers of points

  auto operator<=>(const ArrangedLine&) const = default;
};

/// A triangle of a plane.
struct PlaneTriangle {
  std::uint32_t index = 0;
  glm::uvec3 corner{0};
};

/// Divides triangles of one plane that overlap or touch, or one triangle, along lines and at
/// points.
///   lines   within the triangles
///   points  within the triangles; the ends of lines need not be among them
///   all     gets the points where lines cross
///   out     appended to; pieces that are covered as often from both sides are left out
///   return  why that failed, as a clause: too many lines cross each other; empty if it did not
///   throws  Error(cancelled)
[[nodiscard]] std::string arrangePlane(std::span<const PlaneTriangle> triangles,
                                       std::vector<ArrangedLine> lines,
                                       std::vector<std::uint32_t> points, PointSet& all,
                                       std::vector<ArrangedTriangle>& out,
                                       const Progress* progress);

/// Whole triangles of a mesh and parts of others, or why these could not be made.
struct Arrangement {
  std::vector<ArrangedTriangle> parts{};
  std::string failure{};  ///< a clause; empty if `parts` is valid
};

/// Divides all triangles along their intersections.
///   vertices   of different positions
///   triangles  with area
///   pairs      all that intersect other than in common vertices and edges
///   points     made of `vertices`; gets the new ones
///   isDivided  [triangles] gets 1 for those that others meet
///   throws     Error(cancelled)
[[nodiscard]] Arrangement arrangementOf(std::span<const glm::dvec3> vertices,
                                        std::span<const glm::uvec3> triangles,
                                        std::span<const std::array<std::uint32_t, 2>> pairs,
                                        PointSet& points, std::vector<std::uint8_t>& isDivided,
                                        const Progress* progress);

}  // namespace sherd
