// A mesh as a surface to draw points on.
#pragma once

#include <sherd/mesh.h>

#include <vector>

namespace sherd {

/// A mesh and the sums of its triangles' areas.  Kept by reference.
class SurfaceByArea {
 public:
  /// throws  Error(input) no area
  explicit SurfaceByArea(const TriangleMesh& mesh);

  double area() const { return sums_.back(); }
  std::size_t triangles() const { return sums_.size(); }

  /// Exactly 0 where the triangle has none.
  double area(std::size_t triangle) const {
    return triangle == 0 ? sums_[0] : sums_[triangle] - sums_[triangle - 1];
  }

  /// The triangle at a share of the area, 0 <= share < 1; it has area.
  std::size_t triangleAt(double share) const;

  /// Uniform in the triangle where u and v are uniform in [0, 1).
  glm::dvec3 pointIn(std::size_t triangle, double u, double v) const;

  /// Unit; for triangles that have area.
  glm::dvec3 normalOf(std::size_t triangle) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<double> sums_;  ///< [triangles] area of the triangles up to and with each
};

}  // namespace sherd
