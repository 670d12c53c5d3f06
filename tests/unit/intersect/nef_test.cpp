// Unions of random bodies, against CGAL's Nef polyhedra, which are exact.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Nef_polyhedron_3.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "base/random.h"
#include "intersect/arrange/unite.h"
#include "remesh/bodies.h"
#include "shapes.h"

namespace sherd {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Nef = CGAL::Nef_polyhedron_3<Exact>;

// Random numbers: whole ones below `side`, so that faces lie in each other's planes, or of 0 to 1.
class Numbers {
 public:
  Numbers(std::uint64_t seed, int side) : seed_(seed), side_(side) {}

  double next() {
    const double unit = randomUnit(seed_, Stage::noise, next_++);
    return side_ > 0 ? std::floor(unit * side_) : unit;
  }
  glm::dvec3 point() {
    const double x = next(), y = next();
    return {x, y, next()};
  }
  int below(int count) {
    return static_cast<int>(randomUnit(seed_, Stage::noise, next_++) * count);
  }

 private:
  const std::uint64_t seed_;
  const int side_;
  std::uint64_t next_ = 0;
};

const std::vector<glm::uvec3> kTetrahedron{{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}};
const std::vector<glm::uvec3> kPrism{{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                                     {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};

// A box, a tetrahedron or a triangular prism with a volume.
TriangleMesh convexBody(Numbers& numbers) {
  for (;;) {
    TriangleMesh body;
    const glm::dvec3 a = numbers.point(), b = numbers.point(), c = numbers.point();
    switch (numbers.below(3)) {
      case 0:
        body = shapes::cube(2.0);
        for (glm::dvec3& v : body.vertices) {
          for (int k = 0; k < 3; ++k)
            v[k] = v[k] < 0.0 ? std::min(a[k], b[k]) : std::max(a[k], b[k]);
        }
        break;
      case 1:
        body = {{a, b, c, numbers.point()}, kTetrahedron};
        break;
      default: {  // along an axis, so that its sides are planes of doubles
        const auto axis = static_cast<glm::length_t>(numbers.below(3));
        const double low = numbers.next(), high = numbers.next();
        for (const double at : {low, high}) {
          for (glm::dvec3 corner : {a, b, c}) {
            corner[axis] = at;
            body.vertices.push_back(corner);
          }
        }
        body.triangles = kPrism;
      }
    }
    const double found = volume(body);
    if (found == 0.0) continue;
    for (glm::uvec3& t : body.triangles) {
      if (found < 0.0) std::swap(t.y, t.z);
    }
    return body;
  }
}

// One mesh of all bodies, in which vertices at one position are one.
TriangleMesh mergedMesh(const std::vector<TriangleMesh>& bodies) {
  TriangleMesh out;
  std::map<std::array<double, 3>, std::uint32_t> numbers;
  for (const TriangleMesh& body : bodies) {
    const auto numberOf = [&](std::uint32_t v) {
      const glm::dvec3& p = body.vertices[v];
      const auto [found, isNew] =
          numbers.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(out.vertices.size()));
      if (isNew) out.vertices.push_back(p);
      return found->second;
    };
    for (const glm::uvec3& t : body.triangles)
      out.triangles.emplace_back(numberOf(t.x), numberOf(t.y), numberOf(t.z));
  }
  return out;
}

Nef nefOf(const TriangleMesh& body) {
  CGAL::Surface_mesh<Exact::Point_3> mesh;
  std::vector<CGAL::SM_Vertex_index> vertices;
  for (const glm::dvec3& v : body.vertices) vertices.push_back(mesh.add_vertex({v.x, v.y, v.z}));
  for (const glm::uvec3& t : body.triangles)
    mesh.add_face(vertices[t.x], vertices[t.y], vertices[t.z]);
  return Nef(mesh);
}

struct Measures {
  std::size_t bodies = 0;
  double volume = 0.0;
};

// The number of open connected parts inside, and their volume, by the cones over all facets.
Measures measuresOf(const Nef& nef) {
  Measures measures;
  for (auto v = nef.volumes_begin(); v != nef.volumes_end(); ++v) measures.bodies += v->mark();
  Exact::FT sixfold = 0;
  for (auto facet = nef.halffacets_begin(); facet != nef.halffacets_end(); ++facet) {
    if (!facet->incident_volume()->mark() || facet->twin()->incident_volume()->mark()) continue;
    Exact::Vector_3 twiceArea(0, 0, 0);
    Exact::Vector_3 at(0, 0, 0);
    for (auto cycle = facet->facet_cycles_begin(); cycle != facet->facet_cycles_end(); ++cycle) {
      if (!cycle.is_shalfedge()) continue;
      Nef::SHalfedge_around_facet_const_circulator edge{Nef::SHalfedge_const_handle(cycle)};
      const auto end = edge;
      do {
        const Exact::Vector_3 from = edge->source()->center_vertex()->point() - CGAL::ORIGIN;
        ++edge;
        const Exact::Vector_3 to = edge->source()->center_vertex()->point() - CGAL::ORIGIN;
        twiceArea += CGAL::cross_product(from, to);
        at = from;
      } while (edge != end);
    }
    sixfold += twiceArea * at;
  }
  measures.volume = std::abs(CGAL::to_double(sixfold)) / 6.0;
  return measures;
}

//   side  of the lattice that corners lie on, or 0
void expectUnionsOfNef(std::uint64_t scenes, int side) {
  std::size_t several = 0, changed = 0;
  for (std::uint64_t scene = 0; scene < scenes; ++scene) {
    SCOPED_TRACE(scene);
    Numbers numbers(scene, side);
    std::vector<TriangleMesh> bodies(static_cast<std::size_t>(2 + numbers.below(4)));
    Nef all(Nef::EMPTY);
    for (TriangleMesh& body : bodies) {
      body = convexBody(numbers);
      all += nefOf(body);
    }
    const Measures expected = measuresOf(all);
    const UnitedMesh united = unite(mergedMesh(bodies));
    ASSERT_EQ(united.failure, "");
    EXPECT_NEAR(volume(united.mesh), expected.volume, 1e-9 * expected.volume);
    EXPECT_EQ(bodiesOf(united.mesh).size(), expected.bodies);
    several += expected.bodies > 1;
    changed += united.isChanged;
  }
  EXPECT_GT(several, scenes / 10);  // scenes of all kinds
  EXPECT_GT(changed, scenes / 2);
}

TEST(Nef, UnionsOnACoarseLattice) { expectUnionsOfNef(120, 4); }

TEST(Nef, UnionsInGeneralPosition) { expectUnionsOfNef(30, 0); }

}  // namespace
}  // namespace sherd
