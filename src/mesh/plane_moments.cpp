// Least-squares planes of triangles.
#include "mesh/plane_moments.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "mesh/triangle_area.h"

namespace sherd {

// Jacobi's method, which is accurate also where two eigenvalues are almost equal, as for slivers.
SymmetricEigen eigenOf(glm::dmat3 m) {
  constexpr int kSweeps = 12;
  glm::dmat3 vectors(1.0);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    if (m[0][1] == 0.0 && m[0][2] == 0.0 && m[1][2] == 0.0) break;
    for (const auto& [p, q] : {std::pair(0, 1), {0, 2}, {1, 2}}) {
      if (std::abs(m[p][q]) <= 1e-18 * (std::abs(m[p][p]) + std::abs(m[q][q]))) {
        m[p][q] = m[q][p] = 0.0;
        continue;
      }
      const double ratio = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
      const double t = std::copysign(1.0, ratio) / (std::abs(ratio) + std::hypot(ratio, 1.0));
      const double c = 1.0 / std::hypot(t, 1.0), s = t * c;
      glm::dmat3 rotation(1.0);
      rotation[p][p] = rotation[q][q] = c;
      rotation[q][p] = s;
      rotation[p][q] = -s;
      m = glm::transpose(rotation) * m * rotation;
      vectors = vectors * rotation;
      m[p][q] = m[q][p] = 0.0;
    }
  }
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return m[a][a] > m[b][b]; });
  SymmetricEigen result;
  for (int i = 0; i < 3; ++i) {
    const int k = order[static_cast<std::size_t>(i)];
    result.values[i] = m[k][k];
    result.vectors[static_cast<std::size_t>(i)] = glm::normalize(vectors[k]);
  }
  return result;
}

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
