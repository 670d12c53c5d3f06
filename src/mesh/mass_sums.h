// Sums over triangles that give the mass properties of the solid within them.
#pragma once

#include <sherd/mesh.h>

namespace sherd {

/// The integrals over a solid of 1, (x, y, z), (x^2, y^2, z^2) and (xy, yz, zx), as sums over the
/// signed tetrahedra of its surface's triangles and a reference.  Sums of parts of one surface may
/// be added.  The paper's Subexpressions() sum the same by the divergence theorem, with twice the
/// operations.
///   source  Tonon, Explicit exact formulas for the 3-D tetrahedron inertia tensor, 2005
class MassSums {
 public:
  MassSums() = default;

  ///   reference  near the solid: far from the origin, the terms would be large and cancel
  explicit MassSums(const glm::dvec3& reference) : reference_(reference) {}

  /// Adds a triangle.
  void add(const glm::dvec3& corner0, const glm::dvec3& corner1, const glm::dvec3& corner2);

  /// Adds sums with the same reference.
  void add(const MassSums& part);

  [[nodiscard]] MassProperties properties() const;

 private:
  glm::dvec3 reference_{0.0};
  double one_ = 0.0;
  glm::dvec3 linear_{0.0}, square_{0.0}, mixed_{0.0};
};

}  // namespace sherd
