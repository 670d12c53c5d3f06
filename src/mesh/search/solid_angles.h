// Sum of the solid angles of triangles.
#pragma once

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace sherd {

/// Half of a triangle's solid angle is the argument of a complex number.  While the arguments are
/// small, the numbers are multiplied, so that one arc tangent computes the sum of several angles.
/// source  Van Oosterom, Strackee: The Solid Angle of a Plane Triangle, 1983
class SolidAngles {
 public:
  void add(const std::array<glm::dvec3, 3>& t, const glm::dvec3& point) {
    const glm::dvec3 a = t[0] - point, b = t[1] - point, c = t[2] - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double im = glm::dot(a, glm::cross(b, c));
    const double re =
        la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    if (!(re_ > 0.0 && re > 0.0)) flush();  // else their arguments sum to less than pi
    const double product = re_ * re - im_ * im;
    im_ = re_ * im + im_ * re;
    re_ = product;
    const double size = std::abs(re_) + std::abs(im_);
    if (!(size > kSmallest && size < kLargest)) flush();
  }

  /// Returns steradians; positive for points behind counter-clockwise triangles.
  double sum() {
    flush();
    return sum_;
  }

 private:
  // Factors are cubes of lengths; within these bounds a product with a further factor is finite.
  static constexpr double kSmallest = 1e-60, kLargest = 1e60;

  void flush() {
    sum_ += 2.0 * std::atan2(im_, re_);
    re_ = 1.0;
    im_ = 0.0;
  }
  double re_ = 1.0, im_ = 0.0, sum_ = 0.0;
};

}  // namespace sherd
