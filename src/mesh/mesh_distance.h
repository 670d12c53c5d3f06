// How far points are from a mesh, and on which side.
#pragma once

#include <sherd/mesh.h>

#include <limits>

#include "mesh/inside.h"

namespace sherd {

/// A mesh that is asked for its distance from many points.  Any thread may ask.
///
/// Embree's tree finds the triangles that may be nearest, in single precision with a margin; how
/// far each is, is told in double precision, and the least of them does not depend on the tree.
class MeshDistance {
 public:
  ///   mesh  at least one triangle; copied
  explicit MeshDistance(const TriangleMesh& mesh);

  struct Nearest {
    double distance = 0.0;  ///< world units; infinite where nothing is within reach
    glm::dvec3 point{0.0};  ///< of the mesh, world units
  };

  /// The nearest point of the mesh, if it is within `reach`.
  [[nodiscard]] Nearest nearest(const glm::dvec3& point,
                                double reach = std::numeric_limits<double>::infinity()) const;

  [[nodiscard]] double distance(const glm::dvec3& point) const { return nearest(point).distance; }

  /// Whether the mesh winds round the point.  Three rays tell; where these disagree, or the point
  /// is too near for single precision, the solid angles of all triangles do.
  ///   mesh      closed, oriented outwards
  ///   distance  the point's
  [[nodiscard]] bool contains(const glm::dvec3& point, double distance) const;

  /// The same by rays alone, and faster; points as near the surface as single precision cannot tell
  /// may be wrong.
  [[nodiscard]] bool likelyContains(const glm::dvec3& point) const {
    return rays_.contains(unitFrom(point));
  }

  [[nodiscard]] const Box& box() const { return box_; }

 private:
  [[nodiscard]] glm::dvec3 unitFrom(const glm::dvec3& world) const {
    return (world - middle_) / half_;
  }

  Box box_;
  glm::dvec3 middle_{0.0};  ///< of the box
  double half_ = 1.0;       ///< half the box's longest side, or 1 where that is 0
  TriangleMesh body_;       ///< about the middle, half the longest side being 1
  InsideTest rays_;
};

}  // namespace sherd
