// Measures of a mesh: box, area, volume and mass properties.
#include <sherd/mesh.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sherd {
namespace {

// Integrals are relative to the center of the box: far from the origin their terms would be large
// and cancel.
glm::dvec3 referencePoint(const TriangleMesh& mesh) {
  const Box box = bounds(mesh);
  return 0.5 * (box.min + box.max);
}

glm::dvec3 yzx(const glm::dvec3& v) { return {v.y, v.z, v.x}; }

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

MassProperties massProperties(const TriangleMesh& mesh) {
  // Eberly's integrals over the solid of 1, (x, y, z), (x^2, y^2, z^2) and (xy, yz, zx), as sums
  // over the triangles by the divergence theorem; a vectorized form of the paper's
  // Subexpressions().
  const glm::dvec3 reference = referencePoint(mesh);
  double one = 0.0;
  glm::dvec3 linear(0.0), square(0.0), mixed(0.0);
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.vertices[t.x] - reference;
    const glm::dvec3 b = mesh.vertices[t.y] - reference;
    const glm::dvec3 c = mesh.vertices[t.z] - reference;
    const glm::dvec3 d = glm::cross(b - a, c - a);
    const glm::dvec3 f1 = a + b + c;
    const glm::dvec3 f2 = a * a + b * (a + b) + c * f1;
    const glm::dvec3 f3 = a * a * a + b * (a * a + b * (a + b)) + c * f2;
    const glm::dvec3 ga = f2 + a * (f1 + a), gb = f2 + b * (f1 + b), gc = f2 + c * (f1 + c);
    one += d.x * f1.x;
    linear += d * f2;
    square += d * f3;
    mixed += d * (yzx(a) * ga + yzx(b) * gb + yzx(c) * gc);
  }
  MassProperties mass;
  mass.volume = one / 6.0;
  if (mass.volume == 0.0) {
    mass.centroid = reference;
    return mass;
  }
  const glm::dvec3 m = linear / 24.0 / mass.volume;  // centroid, from the reference point
  const glm::dvec3 s = square / 60.0 - mass.volume * m * m;
  const glm::dvec3 p = mixed / 120.0 - mass.volume * m * yzx(m);  // xy, yz, zx
  mass.centroid = reference + m;
  mass.inertia = glm::dmat3(s.y + s.z, -p.x, -p.z,  //
                            -p.x, s.z + s.x, -p.y,  //
                            -p.z, -p.y, s.x + s.y);
  return mass;
}

}  // namespace sherd
