// The rotation is a continuous function of the piece, so that cracks are the same at every
// resolution.
#include "grow/splits/split_wall.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace sherd {
namespace {

constexpr double kStiffness = 8.0;

double trace(const glm::dmat3& m) { return m[0][0] + m[1][1] + m[2][2]; }

}  // namespace

glm::dvec3 acrossWalls(const CrackedLeaves& leaves, const glm::dmat3& covariance,
                       const glm::dvec3& normal) {
  const double surface = trace(leaves.normals);
  if (!(surface > 0.0) || !(leaves.voxels > 0.0)) return normal;
  const double inPiece = surface / leaves.voxels * std::sqrt(trace(covariance));
  const double weight = std::clamp((inPiece - 3.0) / 3.0, 0.0, 1.0);
  const glm::dmat3 stiff = glm::dmat3(1.0) + weight * kStiffness / surface * leaves.normals;
  return glm::inverse(stiff) * normal;
}

}  // namespace sherd
