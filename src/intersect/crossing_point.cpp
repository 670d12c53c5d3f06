// Points where edges cross triangles, with their exact positions.
#include "intersect/crossing_point.h"

#include <cmath>
#include <optional>

#include "intersect/bounded.h"
#include "intersect/determinant.h"
#include "intersect/dyadic.h"
#include "intersect/homogeneous_point.h"

namespace sherd {
namespace {

void roundExactly(ExactPoint& p, int axis) { roundAlong(positionOf(p), axis, p); }

// Returns true if every number within the error rounds to `high`.
bool isRoundedRight(const Bounded& p) {
  const double error = 2.0 * p.error;
  return p.high + (p.low + error) == p.high && p.high + (p.low - error) == p.high;
}

int exactOrientationAlong(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, int axis) {
  const auto u = static_cast<std::size_t>((axis + 1) % 3);
  const auto v = static_cast<std::size_t>((axis + 2) % 3);
  const HomogeneousPoint a = positionOf(p), b = positionOf(q), c = positionOf(r);
  const Dyadic value = a.weight * (b.at[u] * c.at[v] - b.at[v] * c.at[u]) +
                       b.weight * (c.at[u] * a.at[v] - c.at[v] * a.at[u]) +
                       c.weight * (a.at[u] * b.at[v] - a.at[v] * b.at[u]);
  return value.sign() * a.weight.sign() * b.weight.sign() * c.weight.sign();
}

std::optional<int> preciseOrientation(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r,
                                      int axis) {
  const auto difference = [](const ExactPoint& a, const ExactPoint& b, int k) {
    return Bounded(a.rounded[k], a.rest[k], a.error[k]) -
           Bounded(b.rounded[k], b.rest[k], b.error[k]);
  };
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return signOf(difference(q, p, u) * difference(r, p, v) -
                difference(q, p, v) * difference(r, p, u));
}

// A difference of coordinates in double precision, with a bound of its error.
struct Difference {
  double value, error;

  Difference(const ExactPoint& a, const ExactPoint& b, int k)
      : value(a.rounded[k] - b.rounded[k]),
        error(std::abs(a.rest[k]) + a.error[k] + std::abs(b.rest[k]) + b.error[k] +
              kUnitRoundoff * std::abs(value)) {}

  [[nodiscard]] bool isZero() const { return value == 0.0 && error == 0.0; }

  // Returns a bound of the error of this * other.
  [[nodiscard]] double errorOf(const Difference& other) const {
    return (std::abs(value) + error) * other.error + error * std::abs(other.value);
  }
};

}  // namespace

ExactPoint crossingPoint(const std::array<glm::dvec3, 2>& edge,
                         const std::array<glm::dvec3, 3>& corner) {
  ExactPoint point;
  point.isVertex = false;
  point.edge = edge;
  point.corner = corner;
  const auto& [a, b] = edge;
  const auto& [c, d, e] = corner;
  const Bounded da = determinant<Bounded>(c, d, e, a), db = determinant<Bounded>(c, d, e, b);
  const Bounded fraction = da / (da - db);
  for (int axis = 0; axis < 3; ++axis) {
    // Edges and triangles across an axis are common, and then all points have the same coordinate.
    if (a[axis] == b[axis] || (c[axis] == d[axis] && c[axis] == e[axis])) {
      point.rounded[axis] = a[axis] == b[axis] ? a[axis] : c[axis];
      continue;
    }
    const Bounded at = Bounded(a[axis]) + fraction * Bounded::difference(b[axis], a[axis]);
    if (isRoundedRight(at)) {
      point.rounded[axis] = at.high;
      point.rest[axis] = at.low;
      point.error[axis] = at.error;
    } else {
      roundExactly(point, axis);
    }
  }
  return point;
}

int orientation(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Difference qu(q, p, u), qv(q, p, v), ru(r, p, u), rv(r, p, v);
  if ((qu.isZero() || rv.isZero()) && (qv.isZero() || ru.isZero())) return 0;
  const double left = qu.value * rv.value, right = qv.value * ru.value, value = left - right;
  // Three roundings, and those of the bound.
  const double bound = 1.001 * (qu.errorOf(rv) + qv.errorOf(ru) +
                                4.0 * kUnitRoundoff * (std::abs(left) + std::abs(right))) +
                       kUnderflow;
  if (value > bound) return 1;
  if (value < -bound) return -1;
  if (const std::optional<int> sign = preciseOrientation(p, q, r, axis)) return *sign;
  return exactOrientationAlong(p, q, r, axis);
}

bool areCollinear(const std::array<glm::dvec3, 3>& points) {
  const ExactPoint a(points[0]), b(points[1]), c(points[2]);
  return orientation(a, b, c, 0) == 0 && orientation(a, b, c, 1) == 0 &&
         orientation(a, b, c, 2) == 0;
}

}  // namespace sherd
