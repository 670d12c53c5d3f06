// Exact positions in homogeneous coordinates.
#include "intersect/homogeneous_point.h"

#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "intersect/bounded.h"
#include "intersect/determinant.h"
#include "intersect/predicates.h"

namespace sherd {
namespace {

ExactPoint roundedPoint(HomogeneousPoint exact) {
  ExactPoint p;
  p.isVertex = false;
  for (int axis = 0; axis < 3; ++axis) roundAlong(exact, axis, p);
  p.position = std::make_shared<const HomogeneousPoint>(std::move(exact));
  return p;
}

bool isRoundedExact(const ExactPoint& p) {
  return p.isVertex || (p.rest == glm::dvec3(0.0) && p.error == glm::dvec3(0.0));
}

int exactSide(const std::array<glm::dvec3, 3>& t, const HomogeneousPoint& p) {
  const auto apart = [&](std::size_t k, int axis) {
    return Dyadic::difference(t[k][axis], t[0][axis]);
  };
  const auto from = [&](int axis) {
    return p.at[static_cast<std::size_t>(axis)] - p.weight * Dyadic(t[0][axis]);
  };
  const Dyadic bx = apart(1, 0), by = apart(1, 1), bz = apart(1, 2);
  const Dyadic cx = apart(2, 0), cy = apart(2, 1), cz = apart(2, 2);
  const Dyadic value =
      (by * cz - bz * cy) * from(0) + (bz * cx - bx * cz) * from(1) + (bx * cy - by * cx) * from(2);
  return value.sign() * p.weight.sign();
}

// The sign where it does not take exact numbers.
std::optional<int> quickOrientation(const std::array<glm::dvec3, 3>& t, const ExactPoint& p) {
  const auto apart = [&](std::size_t k, int axis) {
    return Bounded::difference(t[k][axis], t[0][axis]);
  };
  const auto from = [&](int axis) {
    return Bounded(p.rounded[axis], p.rest[axis], p.error[axis]) - Bounded(t[0][axis]);
  };
  const Bounded bx = apart(1, 0), by = apart(1, 1), bz = apart(1, 2);
  const Bounded cx = apart(2, 0), cy = apart(2, 1), cz = apart(2, 2);
  return signOf((by * cz - bz * cy) * from(0) + (bz * cx - bx * cz) * from(1) +
                (bx * cy - by * cx) * from(2));
}

// Proportional to the distance of a point from the line of two others, seen along an axis.
Dyadic distanceFrom(const std::array<HomogeneousPoint, 2>& line, const HomogeneousPoint& p,
                    int axis) {
  const auto u = static_cast<std::size_t>((axis + 1) % 3);
  const auto v = static_cast<std::size_t>((axis + 2) % 3);
  const auto& [a, b] = line;
  return a.weight * (b.at[u] * p.at[v] - b.at[v] * p.at[u]) +
         b.weight * (p.at[u] * a.at[v] - p.at[v] * a.at[u]) +
         p.weight * (a.at[u] * b.at[v] - a.at[v] * b.at[u]);
}

}  // namespace

HomogeneousPoint positionOf(const ExactPoint& p) {
  if (p.isVertex) {
    return {{Dyadic(p.rounded.x), Dyadic(p.rounded.y), Dyadic(p.rounded.z)}, Dyadic(1.0)};
  }
  if (p.position != nullptr) return *p.position;
  const glm::dvec3 &a = p.edge[0], &b = p.edge[1];
  const auto& [c, d, e] = p.corner;
  const Dyadic da = determinant<Dyadic>(c, d, e, a), db = determinant<Dyadic>(c, d, e, b);
  const auto at = [&](int axis) { return Dyadic(b[axis]) * da - Dyadic(a[axis]) * db; };
  return {{at(0), at(1), at(2)}, da - db};
}

void roundAlong(const HomogeneousPoint& exact, int axis, ExactPoint& p) {
  const Dyadic& product = exact.at[static_cast<std::size_t>(axis)];
  p.rounded[axis] = quotient(product, exact.weight);
  const Dyadic rest = product - Dyadic(p.rounded[axis]) * exact.weight;
  p.rest[axis] = quotient(rest, exact.weight);
  p.error[axis] =
      rest.sign() == 0 ? 0.0 : std::abs(p.rest[axis]) * 2.0 * kUnitRoundoff + kUnderflow;
}

int compare(const ExactPoint& p, const ExactPoint& q, int axis) {
  // Rounding keeps the order.
  if (p.rounded[axis] != q.rounded[axis]) return p.rounded[axis] < q.rounded[axis] ? -1 : 1;
  if (isRoundedExact(p) && isRoundedExact(q)) return 0;
  const HomogeneousPoint a = positionOf(p), b = positionOf(q);
  const auto k = static_cast<std::size_t>(axis);
  return (a.at[k] * b.weight - b.at[k] * a.weight).sign() * a.weight.sign() * b.weight.sign();
}

bool areEqual(const ExactPoint& p, const ExactPoint& q) {
  if (p.rounded != q.rounded) return false;
  return compare(p, q, 0) == 0 && compare(p, q, 1) == 0 && compare(p, q, 2) == 0;
}

int orientation(const std::array<glm::dvec3, 3>& triangle, const ExactPoint& p) {
  if (isRoundedExact(p)) return orientation(triangle[0], triangle[1], triangle[2], p.rounded);
  if (const std::optional<int> sign = quickOrientation(triangle, p)) return *sign;
  return exactSide(triangle, positionOf(p));
}

ExactPoint lineCrossing(const std::array<ExactPoint, 2>& p, const std::array<ExactPoint, 2>& q,
                        int axis) {
  const std::array<HomogeneousPoint, 2> line{positionOf(q[0]), positionOf(q[1])};
  const HomogeneousPoint a = positionOf(p[0]), b = positionOf(p[1]);
  const Dyadic ofA = distanceFrom(line, a, axis), ofB = distanceFrom(line, b, axis);
  const auto at = [&](std::size_t k) { return ofA * b.at[k] - ofB * a.at[k]; };
  return roundedPoint({{at(0), at(1), at(2)}, ofA * b.weight - ofB * a.weight});
}

ExactPoint weightedMean(const std::array<ExactPoint, 3>& points,
                        const std::array<int, 3>& weights) {
  HomogeneousPoint sum = positionOf(points[0]);
  const Dyadic first(weights[0]);
  for (Dyadic& x : sum.at) x = x * first;
  double total = weights[0];
  for (std::size_t i = 1; i < 3; ++i) {
    const HomogeneousPoint own = positionOf(points[i]);
    const Dyadic scale = Dyadic(weights[i]) * sum.weight;
    for (std::size_t k = 0; k < 3; ++k) sum.at[k] = sum.at[k] * own.weight + own.at[k] * scale;
    sum.weight = sum.weight * own.weight;
    total += weights[i];
  }
  sum.weight = sum.weight * Dyadic(total);
  return roundedPoint(std::move(sum));
}

}  // namespace sherd
