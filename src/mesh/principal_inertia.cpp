// The principal axes of a body, by OpenVDB's Jacobi iteration.
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
  glm::dmat3 turn;
  for (int axis = 0; axis < 3; ++axis) {
    turn[axis] = {axes(0, axis), axes(1, axis), axes(2, axis)};
  }
  if (glm::determinant(turn) < 0.0) turn[2] = -turn[2];  // a reflection is no turn
  return {size * glm::dvec3(moments.x(), moments.y(), moments.z()),
          glm::normalize(glm::quat_cast(turn))};
}

}  // namespace sherd
