// The principal axes of a solid.
#include "mesh/principal_inertia.h"

#include "mesh/symmetric_eigen.h"

namespace sherd {

PrincipalInertia principalInertia(const MassProperties& mass) {
  const glm::dmat3& m = mass.inertia;
  const double size = m[0][0] + m[1][1] + m[2][2];
  if (!(size > 0.0)) return {};
  const SymmetricEigen eigen = fastEigenOf(m / size);
  glm::dmat3 rotation(eigen.vectors[0], eigen.vectors[1], eigen.vectors[2]);
  if (glm::determinant(rotation) < 0.0) rotation[2] = -rotation[2];  // no reflection
  return {size * eigen.values, glm::normalize(glm::quat_cast(rotation))};
}

}  // namespace sherd
