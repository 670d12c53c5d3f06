// Least-squares planes of triangles.
#include "mesh/plane_moments.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "mesh/symmetric_eigen.h"
#include "mesh/triangle_area.h"

namespace sherd {

void PlaneMoments::add(const std::array<glm::dvec3, 3>& t) {
  const double size = areaOf(t);
  const glm::dvec3 sum = t[0] + t[1] + t[2];
  area += size;
  first += size / 3.0 * sum;
  second += size / 12.0 *
            (glm::outerProduct(t[0], t[0]) + glm::outerProduct(t[1], t[1]) +
             glm::outerProduct(t[2], t[2]) + glm::outerProduct(sum, sum));
}

void PlaneMoments::add(const PlaneMoments& other) {
  area += other.area;
  first += other.first;
  second += other.second;
}

FittedPlane PlaneMoments::plane() const {
  if (!(area > 0.0)) return {};
  const glm::dvec3 mean = first / area;
  const glm::dvec3 normal = eigenOf(second / area - glm::outerProduct(mean, mean)).vectors[2];
  return {normal, glm::dot(normal, mean)};
}

double PlaneMoments::meanSquare(const FittedPlane& plane) const {
  if (!(area > 0.0)) return 0.0;
  const glm::dvec3 mean = first / area;
  const double middle = glm::dot(plane.normal, mean) - plane.offset;
  const glm::dmat3 spread = second / area - glm::outerProduct(mean, mean);
  return std::max(0.0, glm::dot(plane.normal, spread * plane.normal)) + middle * middle;
}

}  // namespace sherd
