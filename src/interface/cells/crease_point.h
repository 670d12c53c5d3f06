// The point of a crease or corner that a few tangent planes determine.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>

namespace sherd {

/// A plane that touches a surface.
struct TangentPlane {
  glm::dvec3 point{0.0};
  glm::dvec3 normal{0.0};  ///< unit
};

/// A box of positions, in 0..1 along each axis for those of a cell.
struct PositionBox {
  glm::dvec3 low{0.0}, high{1.0};
};

/// Distance of vertices from the cell's faces, so that vertices of two cells never coincide.
inline constexpr double kCellMargin = 0.005;

/// Returns a cell without a margin at its faces.
[[nodiscard]] inline PositionBox cellBox(double margin) {
  return {glm::dvec3(margin), glm::dvec3(1.0 - margin)};
}

struct CreasePoint {
  glm::dvec3 at{0.0};
  int rank = 1;            ///< 1: the surface is smooth, 2: a crease, 3: a corner
  bool isClamped = false;  ///< moved to the box, other than along a crease
  double least = 0.0;      ///< the least eigenvalue that counted, above rank 1
};

/// Planes whose normals vary by less are of a smooth surface: the least eigenvalue that counts of
/// the mean of the normals' outer products, whose trace is 1.  Two equal groups of planes reach it
/// at an angle of 20 degrees, one of six and the others at 26 degrees.
inline constexpr double kLeastEigenvalue = 0.03;

/// The crease or corner of a few planes: the quadratic error is minimized along the eigenvectors of
/// the normals' covariance that count.
///   source  Ju, Losasso, Schaefer, Warren: Dual Contouring of Hermite Data, 2002
class CreaseFit {
 public:
  ///   planes  at least one
  ///   mean    the planes' mean point; the result of rank 1
  CreaseFit(std::span<const TangentPlane> planes, const glm::dvec3& mean);

  [[nodiscard]] int rank() const { return rank_; }

  /// Returns the position nearest to all planes, among those nearest to the mean.
  ///   box  of the result: a point outside moves along the crease, or else to the box
  [[nodiscard]] CreasePoint within(const PositionBox& box) const;

 private:
  glm::dvec3 at_{0.0};
  glm::dvec3 along_{0.0};  // of a crease
  int rank_ = 1;
  double least_ = 0.0;
};

/// Returns CreaseFit::within.
[[nodiscard]] inline CreasePoint creasePoint(std::span<const TangentPlane> planes,
                                             const glm::dvec3& mean, const PositionBox& box) {
  return CreaseFit(planes, mean).within(box);
}

}  // namespace sherd
