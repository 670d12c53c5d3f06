// Cracks across thin walls.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace sherd {

/// Rotates a crack's normal into the wall that a piece is, so that the crack crosses it at right
/// angles: where the voxels' variance along one axis is below a twentieth of the others, as in a
/// plate or a sherd of a vessel.  Up to a tenth the normal is rotated partly, beyond not at all: a
/// whole vessel has no wall in one direction.
///   covariance  of the piece
///   normal      not 0
[[nodiscard]] glm::dvec3 acrossWall(const glm::dmat3& covariance, const glm::dvec3& normal);

}  // namespace sherd
