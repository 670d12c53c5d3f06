// A surface through a line that is drawn on a mesh, across what the mesh bounds.
#pragma once

#include <sherd/mesh.h>

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// The surface that lines are drawn on.
class DrawnSurface {
 public:
  ///   mesh  world units, oriented outwards
  explicit DrawnSurface(TriangleMesh mesh);

  struct Point {
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0};  ///< unit, of the smooth surface: interpolated over edges of less than
                             ///< 40 degrees
  };

  /// Returns the closest point of the surface.
  [[nodiscard]] Point closest(const glm::dvec3& point) const;

  /// Returns how deep the solid is below a point; the longest side where it has no other surface.
  [[nodiscard]] double depthBelow(const Point& point) const;

  /// Returns the longest side of the box.
  [[nodiscard]] double longest() const { return longest_; }

 private:
  [[nodiscard]] glm::dvec3 cornerNormal(std::uint32_t triangle, int corner) const;

  TriangleMesh mesh_;
  TriangleTree tree_;
  double longest_;
  std::vector<std::uint32_t> firstAround_, around_;  // triangles around each vertex
};

/// Returns a surface through a line, across the solid that the surface bounds: it contains the
/// normals of the surface along the line, from a fiftieth of the longest side above it to as much
/// below the wall, less where these normals meet.  The line is resampled by a 256th of the longest
/// side and moved onto the surface; normals are averaged over a fiftieth.  An open line is
/// continued straight beyond its ends.
///   line    two points or more, finite; closed if the last is the first, but for a millionth of
///           the longest side
///   return  a strip of triangles whose normals point to the right of the line, seen from outside
///   throws  Error(input) the line has no length, or lies farther from the surface than a tenth of
///           the longest side everywhere
[[nodiscard]] TriangleMesh curtainOf(std::span<const glm::dvec3> line, const DrawnSurface& surface);

}  // namespace sherd
