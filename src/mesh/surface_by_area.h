// Sampling of a mesh's surface by area.
#pragma once

#include <sherd/mesh.h>

#include <vector>

namespace sherd {

/// A mesh, kept by reference, and the cumulative areas of its triangles.
class SurfaceByArea {
 public:
  /// throws  Error(input) no area
  explicit SurfaceByArea(const TriangleMesh& mesh);

  double area() const { return sums_.back(); }
  std::size_t triangles() const { return sums_.size(); }

  /// Exactly 0 for a degenerate triangle.
  double area(std::size_t triangle) const {
    return triangle == 0 ? sums_[0] : sums_[triangle] - sums_[triangle - 1];
  }

  /// Returns the triangle at a fraction of the area, 0 <= share < 1; its area is above 0.
  std::size_t triangleAt(double share) const;

  /// Returns a point that is uniform in the triangle if u and v are uniform in [0, 1).
  glm::dvec3 pointIn(std::size_t triangle, double u, double v) const;

  /// Returns the unit normal of a triangle with area.
  glm::dvec3 normalOf(std::size_t triangle) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<double> sums_;  ///< [triangles] area of triangles 0..i
};

}  // namespace sherd
