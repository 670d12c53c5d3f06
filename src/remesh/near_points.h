// Points, for the question whether others are near one of them.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// Thread-safe.  A look-up takes about the logarithm of the number of points.
class NearPoints {
 public:
  explicit NearPoints(std::span<const glm::dvec3> points) : tree_(asTriangles(points)) {}

  /// Returns whether one of the points is less than a distance away.
  [[nodiscard]] bool areWithin(double distance, const glm::dvec3& from) const {
    return tree_.nearest(from, distance).triangle != TriangleTree::kNone;
  }

 private:
  static TriangleMesh asTriangles(std::span<const glm::dvec3> points) {
    TriangleMesh mesh;
    mesh.vertices.assign(points.begin(), points.end());
    for (std::uint32_t p = 0; p < points.size(); ++p) mesh.triangles.emplace_back(p, p, p);
    return mesh;
  }

  const TriangleTree tree_;
};

}  // namespace sherd
