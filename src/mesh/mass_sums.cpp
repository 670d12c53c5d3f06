// The integrals of a triangle, and the properties of a solid.
#include "mesh/mass_sums.h"

#include <glm/geometric.hpp>

namespace sherd {
namespace {

glm::dvec3 yzx(const glm::dvec3& v) { return {v.y, v.z, v.x}; }

}  // namespace

void MassSums::add(const glm::dvec3& corner0, const glm::dvec3& corner1,
                   const glm::dvec3& corner2) {
  const glm::dvec3 a = corner0 - reference_;
  const glm::dvec3 b = corner1 - reference_;
  const glm::dvec3 c = corner2 - reference_;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double volume = glm::dot(a, normal);  // six times that of the tetrahedron
  const glm::dvec3 sum = a + b + c;
  one_ += volume;
  linear_ += volume * sum;
  square_ += volume * (a * a + b * b + c * c + sum * sum);
  mixed_ += volume * (a * yzx(a) + b * yzx(b) + c * yzx(c) + sum * yzx(sum));
}

void MassSums::add(const MassSums& part) {
  one_ += part.one_;
  linear_ += part.linear_;
  square_ += part.square_;
  mixed_ += part.mixed_;
}

MassProperties MassSums::properties() const {
  MassProperties mass;
  mass.volume = one_ / 6.0;
  if (mass.volume == 0.0) {
    mass.centroid = reference_;
    return mass;
  }
  const glm::dvec3 m = linear_ / 24.0 / mass.volume;  // centroid, from the reference point
  const glm::dvec3 s = square_ / 120.0 - mass.volume * m * m;
  const glm::dvec3 p = mixed_ / 120.0 - mass.volume * m * yzx(m);  // xy, yz, zx
  mass.centroid = reference_ + m;
  mass.inertia = glm::dmat3(s.y + s.z, -p.x, -p.z,  //
                            -p.x, s.z + s.x, -p.y,  //
                            -p.z, -p.y, s.x + s.y);
  return mass;
}

}  // namespace sherd
