// Quadric error: the weighted sum of squared distances from a point to planes.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace sherd {

/// x A x + 2 b x + c.
///   source  Garland, Heckbert, Surface simplification using quadric error metrics, 1997
struct Quadric {
  glm::dmat3 a{0.0};  ///< symmetric
  glm::dvec3 b{0.0};
  double c = 0.0;

  /// Returns the squared distance to the plane through `point` with unit `normal`, times `weight`.
  static Quadric plane(const glm::dvec3& normal, const glm::dvec3& point, double weight) {
    const double d = -glm::dot(normal, point);
    return {weight * glm::outerProduct(normal, normal), weight * d * normal, weight * d * d};
  }

  Quadric& operator+=(const Quadric& other) {
    a += other.a;
    b += other.b;
    c += other.c;
    return *this;
  }

  double operator()(const glm::dvec3& x) const {
    return glm::dot(x, a * x) + 2.0 * glm::dot(b, x) + c;
  }
  double weight() const { return a[0][0] + a[1][1] + a[2][2]; }  ///< of all planes
};

/// Solves m x = y, m symmetric and positive definite, by Cholesky factorization: the inverse by
/// cofactors loses all precision where planes are nearly parallel.
inline glm::dvec3 solved(const glm::dmat3& m, const glm::dvec3& y) {
  const double l00 = std::sqrt(m[0][0]), l10 = m[0][1] / l00, l20 = m[0][2] / l00;
  const double l11 = std::sqrt(m[1][1] - l10 * l10), l21 = (m[1][2] - l20 * l10) / l11;
  const double l22 = std::sqrt(m[2][2] - l20 * l20 - l21 * l21);
  const double z0 = y.x / l00, z1 = (y.y - l10 * z0) / l11, z2 = (y.z - l20 * z0 - l21 * z1) / l22;
  const double x2 = z2 / l22, x1 = (z1 - l21 * x2) / l11;
  return {(z0 - l10 * x1 - l20 * x2) / l00, x1, x2};
}

}  // namespace sherd
