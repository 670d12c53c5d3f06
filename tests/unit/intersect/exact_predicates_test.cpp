// Exact predicates and crossing points, against rational numbers.
#include <gtest/gtest.h>

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/random.h"
#include "intersect/bounded.h"
#include "intersect/crossing_point.h"
#include "intersect/predicates.h"

namespace sherd {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using RationalPoint = std::array<Rational, 3>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}
  double unit() { return randomUnit(seed_, Stage::noise, next_++); }
  double within(double size) { return size * (2.0 * unit() - 1.0); }
  glm::dvec3 point(double size) {
    const double x = within(size), y = within(size);
    return {x, y, within(size)};
  }

 private:
  std::uint64_t seed_, next_ = 0;
};

RationalPoint rational(const glm::dvec3& p) {
  return {Rational(p.x), Rational(p.y), Rational(p.z)};
}

RationalPoint minus(const RationalPoint& a, const RationalPoint& b) {
  return {Rational(a[0] - b[0]), Rational(a[1] - b[1]), Rational(a[2] - b[2])};
}

Rational determinant(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                     const glm::dvec3& d) {
  const RationalPoint o = rational(a), u = minus(rational(b), o), v = minus(rational(c), o),
                      w = minus(rational(d), o);
  return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
         (u[0] * v[1] - u[1] * v[0]) * w[2];
}

RationalPoint rationalCrossing(const std::array<glm::dvec3, 2>& edge,
                               const std::array<glm::dvec3, 3>& corner) {
  const Rational a = determinant(corner[0], corner[1], corner[2], edge[0]);
  const Rational b = determinant(corner[0], corner[1], corner[2], edge[1]);
  const Rational t = a / (a - b);
  const RationalPoint p = rational(edge[0]), along = minus(rational(edge[1]), p);
  return {Rational(p[0] + t * along[0]), Rational(p[1] + t * along[1]),
          Rational(p[2] + t * along[2])};
}

RationalPoint rationalOf(const ExactPoint& p) {
  return p.isVertex ? rational(p.rounded) : rationalCrossing(p.edge, p.corner);
}

int signOfArea(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, int axis) {
  const auto u = static_cast<std::size_t>((axis + 1) % 3);
  const auto v = static_cast<std::size_t>((axis + 2) % 3);
  const RationalPoint o = rationalOf(p), a = minus(rationalOf(q), o), b = minus(rationalOf(r), o);
  return Rational(a[u] * b[v] - a[v] * b[u]).sign();
}

Rational size(const Rational& x) { return x.sign() < 0 ? Rational(-x) : x; }

// A fourth point as near to the plane of the other three as rounding allows.
glm::dvec3 inPlane(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, Random& random) {
  const double s = random.within(2.0), t = random.within(2.0);
  return a + s * (b - a) + t * (c - a);
}

TEST(ExactPredicates, OrientationIsThatOfRationalNumbers) {
  Random random(1);
  int zeros = 0;
  for (int i = 0; i < 3000; ++i) {
    const double scale = std::pow(10.0, random.within(8.0));
    const glm::dvec3 shift = i % 2 == 0 ? glm::dvec3(0.0) : random.point(1e4 * scale);
    const glm::dvec3 a = shift + random.point(scale), b = shift + random.point(scale),
                     c = shift + random.point(scale);
    const glm::dvec3 d = i % 3 == 0 ? shift + random.point(scale) : inPlane(a, b, c, random);
    const int expected = determinant(a, b, c, d).sign();
    zeros += expected == 0;
    ASSERT_EQ(orientation(a, b, c, d), expected) << i;
  }
  EXPECT_LT(zeros, 300);
}

TEST(ExactPredicates, OrientationFindsPointsExactlyInThePlane) {
  Random random(2);
  const auto multiple = [&] { return std::floor(random.within(1000.0)) / 1024.0; };
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 a(multiple(), multiple(), multiple()), b(multiple(), multiple(), multiple()),
        c(multiple(), multiple(), multiple());
    EXPECT_EQ(orientation(a, b, c, b + (c - a)), 0);
    EXPECT_EQ(orientation(a, b, c, a + 0.25 * (b - a) + 0.5 * (c - a)), 0);
  }
}

TEST(ExactPredicates, OrientationIsPositiveInFront) {
  const glm::dvec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(orientation(a, b, c, {0.3, 0.3, 1e-300}), 1);
  EXPECT_EQ(orientation(a, b, c, {0.3, 0.3, -1e-300}), -1);
  EXPECT_EQ(orientation(a, b, c, {7.0, -9.0, 0.0}), 0);
}

TEST(ExactPredicates, OrientationSurvivesUnderflowAndOverflow) {
  for (const double s : {1e-150, 1e-120, 1e120, 1e150}) {
    const glm::dvec3 a(0, 0, 0), b(s, 0, 0), c(0, s, 0);
    EXPECT_EQ(orientation(a, b, c, {0, 0, s}), 1) << s;
    EXPECT_EQ(orientation(a, c, b, {0, 0, s}), -1) << s;
    EXPECT_EQ(orientation(a, b, c, {s, s, 0}), 0) << s;
  }
}

TEST(ExactPredicates, OrientationChangesItsSignWithEverySwap) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    std::array<glm::dvec3, 4> p{random.point(1), random.point(1), random.point(1), {}};
    p[3] = inPlane(p[0], p[1], p[2], random);
    const int sign = orientation(p[0], p[1], p[2], p[3]);
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<glm::dvec3, 4> q = p;
      std::swap(q[k], q[k + 1]);
      EXPECT_EQ(orientation(q[0], q[1], q[2], q[3]), -sign);
    }
    EXPECT_EQ(orientation(p[1], p[2], p[0], p[3]), sign);
  }
}

TEST(Bounded, ErrorsAreWithinTheirBound) {
  Random random(4);
  const auto value = [](const Bounded& b) { return Rational(Rational(b.high) + Rational(b.low)); };
  for (int i = 0; i < 3000; ++i) {
    const auto draw = [&] {
      const Bounded sum = Bounded::difference(random.within(1.0), random.within(1e-3));
      return sum * Bounded::difference(std::ldexp(random.within(1.0), i % 60), random.within(1.0));
    };
    const Bounded a = draw(), b = draw();
    const auto expectWithin = [&](const Bounded& result, const Rational& exact) {
      // The operands count as exact here.
      EXPECT_LE(size(value(result) - exact), Rational(result.error));
      EXPECT_LE(std::abs(result.low), std::abs(result.high) * 0x1p-53);
    };
    expectWithin(a + b, value(a) + value(b));
    expectWithin(a - b, value(a) - value(b));
    expectWithin(a * b, value(a) * value(b));
    expectWithin(a / b, value(a) / value(b));
  }
}

// An edge through a triangle; some triangles are large, some edges end close to the plane.
std::pair<std::array<glm::dvec3, 2>, std::array<glm::dvec3, 3>> drawCrossing(Random& random,
                                                                             int i) {
  while (true) {
    const double large = i % 2 == 0 ? 1.0 : 100.0;
    const glm::dvec3 shift = i % 3 == 0 ? glm::dvec3(0.0) : random.point(10.0);
    const std::array<glm::dvec3, 3> t{shift + random.point(large), shift + random.point(large),
                                      shift + random.point(large)};
    std::array<glm::dvec3, 2> e{shift + random.point(1.0), shift + random.point(1.0)};
    if (i % 5 == 0) e[0] = inPlane(t[0], t[1], t[2], random);
    if (i % 10 == 0) e[1] = inPlane(t[0], t[1], t[2], random);  // needs exact arithmetic
    const int a = orientation(t[0], t[1], t[2], e[0]), b = orientation(t[0], t[1], t[2], e[1]);
    if (a * b < 0) return {e, t};
  }
}

TEST(CrossingPoint, IsRoundedToNearest) {
  Random random(5);
  for (int i = 0; i < 1500; ++i) {
    const auto [edge, corner] = drawCrossing(random, i);
    const ExactPoint p = crossingPoint(edge, corner);
    const RationalPoint exact = rationalCrossing(edge, corner);
    for (int axis = 0; axis < 3; ++axis) {
      const double r = p.rounded[axis];
      const Rational& x = exact[static_cast<std::size_t>(axis)];
      const Rational off = size(Rational(x - Rational(r)));
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      EXPECT_LE(off, size(Rational(x - Rational(std::nextafter(r, kInfinity)))));
      EXPECT_LE(off, size(Rational(x - Rational(std::nextafter(r, -kInfinity)))));
      EXPECT_LE(size(Rational(x - Rational(r) - Rational(p.rest[axis]))), Rational(p.error[axis]));
    }
  }
}

TEST(CrossingPoint, IsRoundedToNearestWhereProductsOverflow) {
  for (const double s : {1.0, 1e-110, 1e110}) {
    const ExactPoint p = crossingPoint({{{0.1 * s, 0.2 * s, -s}, {0.7 * s, 0.3 * s, 2.0 * s}}},
                                       {{{-s, -s, 0.0}, {2.0 * s, -s, 0.01 * s}, {0.0, s, 0.0}}});
    const RationalPoint exact = rationalCrossing(p.edge, p.corner);
    EXPECT_EQ(p.rounded.x, exact[0].convert_to<double>()) << s;
    EXPECT_EQ(p.rounded.y, exact[1].convert_to<double>()) << s;
    EXPECT_EQ(p.rounded.z, exact[2].convert_to<double>()) << s;
  }
}

TEST(CrossingPoint, IsExactOnCoordinatesThatAllShare) {
  const ExactPoint p = crossingPoint({{{0.1, 0.2, -0.3}, {0.4, 0.2, 0.7}}},
                                     {{{-1.0, -1.0, 0.1}, {2.0, -1.0, 0.1}, {0.0, 3.0, 0.1}}});
  EXPECT_EQ(p.rounded.y, 0.2);
  EXPECT_EQ(p.rounded.z, 0.1);
  EXPECT_EQ(p.error.y, 0.0);
  EXPECT_EQ(p.error.z, 0.0);
}

TEST(CrossingPoint, OrientationIsThatOfRationalNumbers) {
  Random random(6);
  for (int i = 0; i < 600; ++i) {
    // Crossings of one triangle with edges of a nearly plane strip: close to a line.
    const std::array<glm::dvec3, 3> t{random.point(1.0), random.point(1.0), random.point(1.0)};
    const glm::dvec3 o = inPlane(t[0], t[1], t[2], random), u = random.point(1.0),
                     v = random.point(1.0);
    std::array<ExactPoint, 3> p;
    for (ExactPoint& point : p) {
      for (bool crosses = false; !crosses;) {
        const std::array<glm::dvec3, 2> edge{o + random.within(1.0) * u + random.within(1.0) * v,
                                             o + random.within(1.0) * u + random.within(1.0) * v};
        crosses =
            orientation(t[0], t[1], t[2], edge[0]) * orientation(t[0], t[1], t[2], edge[1]) < 0;
        if (crosses) point = crossingPoint(edge, t);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(orientation(p[0], p[1], p[2], axis), signOfArea(p[0], p[1], p[2], axis));
      EXPECT_EQ(orientation(p[1], p[0], p[2], axis), -signOfArea(p[0], p[1], p[2], axis));
      // Collinear exactly: twice the same point, and a point on a triangle's edge.
      EXPECT_EQ(orientation(p[0], p[0], p[2], axis), 0);
    }
  }
}

TEST(CrossingPoint, IsExactlyOnItsEdge) {
  Random random(7);
  for (int i = 0; i < 300; ++i) {
    const auto [edge, corner] = drawCrossing(random, i);
    const ExactPoint p = crossingPoint(edge, corner), a(edge[0]), b(edge[1]);
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(orientation(a, b, p, axis), 0);
  }
}

}  // namespace
}  // namespace sherd
