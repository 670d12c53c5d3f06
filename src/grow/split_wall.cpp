// A power of a matrix stands for an eigenvector: it is continuous, so that cracks are the same at
// every resolution.
#include "grow/split_wall.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace sherd {
namespace {

double trace(const glm::dmat3& m) { return m[0][0] + m[1][1] + m[2][2]; }

glm::dmat3 adjugate(const glm::dmat3& m) {
  return glm::transpose(
      glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])));
}

}  // namespace

glm::dvec3 acrossWall(const glm::dmat3& covariance, const glm::dvec3& normal) {
  const glm::dmat3 minors = adjugate(covariance);
  const double sum = trace(minors);
  if (!(sum > 0.0)) return normal;
  // Of a plate twice the ratio of the least variance to the others, of a rod 1/4, of a ball 1/3.
  const double thickness = glm::determinant(covariance) * trace(covariance) / (sum * sum);
  const double weight = std::clamp((0.2 - thickness) / 0.1, 0.0, 1.0);
  glm::dmat3 across = minors / sum;  // powers of it approach the projection onto the wall's normal
  for (int i = 0; i < 3; ++i) {
    across = across * across;
    across /= trace(across);
  }
  const glm::dvec3 inside = normal - weight * (across * normal);
  // A crack along the wall, which would split it in layers, has no direction in it.
  return glm::length(inside) > 0.1 * glm::length(normal) ? inside : normal;
}

}  // namespace sherd
