// Barycentric coordinates.
#include "appearance/weights.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace sherd {

glm::dvec3 weightsAt(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                     const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const double bb = glm::dot(ab, ab), bc = glm::dot(ab, ac), cc = glm::dot(ac, ac);
  const double determinant = bb * cc - bc * bc;
  if (!(determinant > 1e-12 * bb * cc)) {
    const glm::dvec3 bp = p - b, cp = p - c;
    const double toA = glm::dot(ap, ap), toB = glm::dot(bp, bp), toC = glm::dot(cp, cp);
    if (toA <= toB && toA <= toC) return {1.0, 0.0, 0.0};
    return toB <= toC ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
  }
  const double pb = glm::dot(ap, ab), pc = glm::dot(ap, ac);
  const double v = std::clamp((cc * pb - bc * pc) / determinant, 0.0, 1.0);
  const double w = std::clamp((bb * pc - bc * pb) / determinant, 0.0, 1.0 - v);
  return {1.0 - v - w, v, w};
}

}  // namespace sherd
