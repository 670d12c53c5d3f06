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
  const glm::dvec3 d = glm::cross(b - a, c - a);
  const glm::dvec3 f1 = a + b + c;
  const glm::dvec3 f2 = a * a + b * (a + b) + c * f1;
  const glm::dvec3 f3 = a * a * a + b * (a * a + b * (a + b)) + c * f2;
  const glm::dvec3 ga = f2 + a * (f1 + a), gb = f2 + b * (f1 + b), gc = f2 + c * (f1 + c);
  one_ += d.x * f1.x;
  linear_ += d * f2;
  square_ += d * f3;
  mixed_ += d * (yzx(a) * ga + yzx(b) * gb + yzx(c) * gc);
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
  const glm::dvec3 s = square_ / 60.0 - mass.volume * m * m;
  const glm::dvec3 p = mixed_ / 120.0 - mass.volume * m * yzx(m);  // xy, yz, zx
  mass.centroid = reference_ + m;
  mass.inertia = glm::dmat3(s.y + s.z, -p.x, -p.z,  //
                            -p.x, s.z + s.x, -p.y,  //
                            -p.z, -p.y, s.x + s.y);
  return mass;
}

}  // namespace sherd
