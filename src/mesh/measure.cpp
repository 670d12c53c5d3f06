// What can be measured on a mesh: its box, area, volume and mass properties.
#include <sherd/mesh.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sherd {
namespace {

// Integrals are taken about the middle of the box: far from the origin the terms would be large and
// cancel.
glm::dvec3 referencePoint(const TriangleMesh& mesh) {
  const Box box = bounds(mesh);
  return 0.5 * (box.min + box.max);
}

}  // namespace

Box bounds(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Box box{mesh.vertices.front(), mesh.vertices.front()};
  for (const glm::dvec3& v : mesh.vertices) {
    box.min = glm::min(box.min, v);
    box.max = glm::max(box.max, v);
  }
  return box;
}

double longestSide(const Box& box) {
  const glm::dvec3 side = box.max - box.min;
  return std::max({side.x, side.y, side.z});
}

double area(const TriangleMesh& mesh) {
  double twice = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3& a = mesh.vertices[t.x];
    twice += glm::length(glm::cross(mesh.vertices[t.y] - a, mesh.vertices[t.z] - a));
  }
  return twice / 2.0;
}

double volume(const TriangleMesh& mesh) {
  const glm::dvec3 reference = referencePoint(mesh);
  double sixfold = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.vertices[t.x] - reference;
    const glm::dvec3 b = mesh.vertices[t.y] - reference;
    const glm::dvec3 c = mesh.vertices[t.z] - reference;
    sixfold += glm::dot(a, glm::cross(b, c));
  }
  return sixfold / 6.0;
}

namespace {

// Three numbers and a 0, in one register where the processor has such.
using Lanes = double __attribute__((vector_size(32)));

// Always inlined: with other instructions a function would be handed such values in another way.
#define SHERD_INLINE [[gnu::always_inline]] inline

SHERD_INLINE Lanes lanes(const glm::dvec3& v) { return Lanes{v.x, v.y, v.z, 0.0}; }

SHERD_INLINE Lanes yzx(const Lanes& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }

SHERD_INLINE Lanes zxy(const Lanes& v) { return __builtin_shufflevector(v, v, 2, 0, 1, 3); }

SHERD_INLINE Lanes cross(const Lanes& a, const Lanes& b) {
  return yzx(a) * zxy(b) - yzx(b) * zxy(a);
}

#undef SHERD_INLINE

// The same operations in the same order whatever the processor has: the same bits.  Clang refuses
// such values between functions for different processors even where they are inlined.
#if defined(__x86_64__) && !defined(__clang__)
#define SHERD_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define SHERD_WIDE
#endif

glm::dvec3 vector(const Lanes& v) { return {v[0], v[1], v[2]}; }

}  // namespace

SHERD_WIDE MassProperties massProperties(const TriangleMesh& mesh) {
  // Eberly's integrals over the solid of 1, (x, y, z), (x^2, y^2, z^2) and (xy, yz, zx), each
  // turned into a sum over the triangles by the divergence theorem; a component-wise form of the
  // paper's Subexpressions().
  const glm::dvec3 reference = referencePoint(mesh);
  const Lanes from = lanes(reference);
  double one = 0.0;
  Lanes linears{}, squares{}, mixeds{};
  for (const glm::uvec3& t : mesh.triangles) {
    const Lanes a = lanes(mesh.vertices[t.x]) - from;
    const Lanes b = lanes(mesh.vertices[t.y]) - from;
    const Lanes c = lanes(mesh.vertices[t.z]) - from;
    const Lanes d = cross(b - a, c - a);
    const Lanes f1 = a + b + c;
    const Lanes f2 = a * a + b * (a + b) + c * f1;
    const Lanes f3 = a * a * a + b * (a * a + b * (a + b)) + c * f2;
    const Lanes ga = f2 + a * (f1 + a), gb = f2 + b * (f1 + b), gc = f2 + c * (f1 + c);
    one += d[0] * f1[0];
    linears += d * f2;
    squares += d * f3;
    mixeds += d * (yzx(a) * ga + yzx(b) * gb + yzx(c) * gc);
  }
  const glm::dvec3 linear = vector(linears), square = vector(squares), mixed = vector(mixeds);
  MassProperties mass;
  mass.volume = one / 6.0;
  if (mass.volume == 0.0) {
    mass.centroid = reference;
    return mass;
  }
  const glm::dvec3 m = linear / 24.0 / mass.volume;  // centroid, from the reference point
  const glm::dvec3 s = square / 60.0 - mass.volume * m * m;
  const glm::dvec3 p = mixed / 120.0 - mass.volume * m * glm::dvec3(m.y, m.z, m.x);  // xy, yz, zx
  mass.centroid = reference + m;
  mass.inertia = glm::dmat3(s.y + s.z, -p.x, -p.z,  //
                            -p.x, s.z + s.x, -p.y,  //
                            -p.z, -p.y, s.x + s.y);
  return mass;
}

}  // namespace sherd
