// Exact predicates and crossings of triangles, against CGAL's kernel with exact predicates.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/random.h"
#include "intersect/predicates.h"
#include "intersect/self_crossings.h"

namespace sherd {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

// Points of a coarse lattice, so that many are on one plane or line, or of a ball of doubles.
class Points {
 public:
  Points(std::uint64_t seed, int side) : seed_(seed), side_(side) {}

  glm::dvec3 next() {
    const double x = coordinate(), y = coordinate();
    return {x, y, coordinate()};
  }

 private:
  double coordinate() {
    const double unit = randomUnit(seed_, Stage::noise, next_++);
    return side_ > 0 ? std::floor(unit * side_) : 2.0 * unit - 1.0;
  }

  const std::uint64_t seed_;
  const int side_;  // of the lattice, or 0
  std::uint64_t next_ = 0;
};

Kernel::Point_3 cgal(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

Kernel::Triangle_3 cgal(const std::array<glm::dvec3, 3>& t) {
  return {cgal(t[0]), cgal(t[1]), cgal(t[2])};
}

TEST(CgalKernel, FindsTheSameOrientation) {
  for (const int side : {0, 2, 3, 5}) {
    Points points(17, side);
    for (int i = 0; i < 4000; ++i) {
      const glm::dvec3 a = points.next(), b = points.next(), c = points.next(), d = points.next();
      EXPECT_EQ(orientation(a, b, c, d),
                static_cast<int>(CGAL::orientation(cgal(a), cgal(b), cgal(c), cgal(d))));
    }
  }
}

TEST(CgalKernel, FindsTheSameCrossings) {
  std::size_t crossing = 0, apart = 0;
  for (const int side : {0, 2, 3, 5}) {
    Points points(18, side);
    for (int i = 0; i < 3000; ++i) {
      std::array<std::array<glm::dvec3, 3>, 2> pair;
      std::vector<glm::dvec3> vertices;
      for (auto& triangle : pair) {
        for (glm::dvec3& corner : triangle) vertices.push_back(corner = points.next());
      }
      const Kernel::Triangle_3 first = cgal(pair[0]), second = cgal(pair[1]);
      if (first.is_degenerate() || second.is_degenerate()) continue;
      const bool isCrossing =
          !selfCrossings(vertices, std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}}, nullptr).empty();
      EXPECT_EQ(isCrossing, CGAL::do_intersect(first, second)) << "lattice " << side << ", " << i;
      ++(isCrossing ? crossing : apart);
    }
  }
  EXPECT_GT(crossing, 1000u);
  EXPECT_GT(apart, 1000u);
}

}  // namespace
}  // namespace sherd
