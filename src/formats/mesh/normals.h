// Normals that a file gives for the corners of its faces.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Makes all normals of a reader's result unit vectors.  Those of unit length in single precision
/// stay as they are; those without a direction become their triangle's, or (0, 1, 0) if it has no
/// area.  If none has a direction, all are dropped.
///   mesh  its triangles refer to its vertices
void completeNormals(RawMesh& mesh);

/// Returns the transform of normals, up to a positive factor, for positions that are transformed
/// linearly.  Of a singular transform it is the limit.
[[nodiscard]] inline glm::dmat3 normalTransform(const glm::dmat3& linear) {
  const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                             glm::cross(linear[0], linear[1]));
  return glm::determinant(linear) < 0.0 ? -cofactors : cofactors;
}

/// Returns the unit vector of a normal after `transform`; zero if it has no direction.
[[nodiscard]] inline glm::vec3 transformedNormal(const glm::dmat3& transform,
                                                 const glm::vec3& normal) {
  const glm::dvec3 out = transform * glm::dvec3(normal);
  const double length = glm::length(out);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(out / length) : glm::vec3(0.0f);
}

}  // namespace sherd
