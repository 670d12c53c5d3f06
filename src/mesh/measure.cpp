// Measures of a mesh: box, area, volume and mass properties.
#include <sherd/mesh.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "mesh/mass_sums.h"

namespace sherd {
namespace {

// Integrals are relative to the center of the box: far from the origin their terms would be large
// and cancel.
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

MassProperties massProperties(const TriangleMesh& mesh) {
  MassSums sums(referencePoint(mesh));
  for (const glm::uvec3& t : mesh.triangles) {
    sums.add(mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]);
  }
  return sums.properties();
}

}  // namespace sherd
