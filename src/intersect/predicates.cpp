// Exact signs of determinants of points.
#include "intersect/predicates.h"

#include <cmath>
#include <optional>

#include "intersect/bounded.h"
#include "intersect/determinant.h"
#include "intersect/dyadic.h"

namespace sherd {
namespace {

// Shewchuk's bound A of orient3d, relative to the sum of the products' sizes.
constexpr double kRelativeError = (7.0 + 56.0 * kUnitRoundoff) * kUnitRoundoff;
// That bound leaves out underflow.

int exactOrientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                     const glm::dvec3& d) {
  for (int axis = 0; axis < 3; ++axis) {  // in the plane of two axes, as much of what is built
    if (a[axis] == b[axis] && a[axis] == c[axis] && a[axis] == d[axis]) return 0;
  }
  if (const std::optional<int> sign = signOf(determinant<Bounded>(a, b, c, d))) return *sign;
  return determinant<Dyadic>(a, b, c, d).sign();
}

}  // namespace

int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                const glm::dvec3& d) {
  const glm::dvec3 ab = b - a, ac = c - a, ad = d - a;
  const double yz = ab.y * ac.z, zy = ab.z * ac.y;
  const double zx = ab.z * ac.x, xz = ab.x * ac.z;
  const double xy = ab.x * ac.y, yx = ab.y * ac.x;
  const double value = (yz - zy) * ad.x + (zx - xz) * ad.y + (xy - yx) * ad.z;
  const double size = (std::abs(yz) + std::abs(zy)) * std::abs(ad.x) +
                      (std::abs(zx) + std::abs(xz)) * std::abs(ad.y) +
                      (std::abs(xy) + std::abs(yx)) * std::abs(ad.z);
  const double bound = kRelativeError * size + kUnderflow;
  if (value > bound) return 1;
  if (value < -bound) return -1;
  return exactOrientation(a, b, c, d);
}

}  // namespace sherd
