// Cracks across thin walls.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace sherd {

/// What a crack passes through: leaves with voxels of its piece near the plane.
struct CrackedLeaves {
  double voxels = 0.0;
  glm::dmat3 normals{0.0};  ///< sum of n n^T over voxels at the surface, see wall_normals.h
};

/// Rotates a crack's normal into the walls that the crack passes, so that it crosses them at right
/// angles as nearly as a plane can: n becomes (I + 8 W)^-1 n, where W is the mean of n n^T over
/// the surface there.  In the wall of a plate or a sherd an angle of 10 degrees becomes 1.1; across
/// a tube one of 30 becomes 7.  Blocks have no walls: with L the piece's standard deviation in
/// space, the normal is rotated where there are more than 6 voxels at the surface in L of those
/// passed (walls thinner than about a third of L), partly from 3 on.
///   covariance  of the piece
///   normal      not 0
[[nodiscard]] glm::dvec3 acrossWalls(const CrackedLeaves& leaves, const glm::dmat3& covariance,
                                     const glm::dvec3& normal);

}  // namespace sherd
