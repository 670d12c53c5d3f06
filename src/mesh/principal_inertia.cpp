// The principal axes of a solid, by OpenVDB's Jacobi iteration.
#include "mesh/principal_inertia.h"

#include <openvdb/math/Mat3.h>

namespace sherd {

PrincipalInertia principalInertia(const MassProperties& mass) {
  const glm::dmat3& m = mass.inertia;
  const double size = m[0][0] + m[1][1] + m[2][2];
  if (!(size > 0.0)) return {};
  openvdb::math::Mat3d inertia, axes;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) inertia(row, column) = m[column][row] / size;
  }
  openvdb::math::Vec3d moments;
  if (!openvdb::math::diagonalizeSymmetricMatrix(inertia, axes, moments)) return {};
  glm::dmat3 rotation;
  for (int axis = 0; axis < 3; ++axis) {
    rotation[axis] = {axes(0, axis), axes(1, axis), axes(2, axis)};
  }
  if (glm::determinant(rotation) < 0.0) rotation[2] = -rotation[2];  // no reflection
  return {size * glm::dvec3(moments.x(), moments.y(), moments.z()),
          glm::normalize(glm::quat_cast(rotation))};
}

}  // namespace sherd
