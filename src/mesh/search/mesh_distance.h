// Distance of points from a mesh, and their side.
#pragma once

#include <sherd/mesh.h>

#include <limits>

#include "mesh/search/inside.h"

namespace sherd {

/// Computes the distances of many points from a mesh.  Thread-safe.
///
/// Embree's tree finds candidates for the nearest triangle in single precision with a margin; their
/// distances are computed in double precision, and the least does not depend on the tree.
class MeshDistance {
 public:
  ///   mesh  at least one triangle; copied
  explicit MeshDistance(const TriangleMesh& mesh);

  struct Nearest {
    double distance = 0.0;  ///< world units; infinite if nothing is within reach
    glm::dvec3 point{0.0};  ///< closest point of the mesh, world units
  };

  /// Returns the closest point of the mesh, if it is within `reach`.
  [[nodiscard]] Nearest nearest(const glm::dvec3& point,
                                double reach = std::numeric_limits<double>::infinity()) const;

  [[nodiscard]] double distance(const glm::dvec3& point) const { return nearest(point).distance; }

  /// Whether the point is inside, for a closed mesh oriented outwards.  Three rays decide; if they
  /// disagree, or the point is too near the surface for single precision, the solid angle of all
  /// triangles decides.
  ///   distance  of the point from the mesh
  [[nodiscard]] bool contains(const glm::dvec3& point, double distance) const;

  /// The same by rays alone, which is faster but can be wrong for points nearer to the surface than
  /// single precision resolves.
  [[nodiscard]] bool likelyContains(const glm::dvec3& point) const {
    return rays_.contains(unitFrom(point));
  }

  [[nodiscard]] const Box& box() const { return box_; }

 private:
  [[nodiscard]] glm::dvec3 unitFrom(const glm::dvec3& world) const {
    return (world - center_) / half_;
  }

  Box box_;
  glm::dvec3 center_{0.0};  ///< of the box
  double half_ = 1.0;       ///< half the box's longest side, or 1 if that is 0
  TriangleMesh unitMesh_;   ///< centered, scaled by 1 / half_
  InsideTest rays_;
};

}  // namespace sherd
