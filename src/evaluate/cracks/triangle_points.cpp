// Spreads points over triangles.
#include "evaluate/cracks/triangle_points.h"

#include <cmath>

#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr int kMostSteps = 16;  // points along an edge

}  // namespace

std::vector<glm::dvec3> pointsOn(const std::array<glm::dvec3, 3>& triangle, double spacing) {
  const auto& [p, q, r] = triangle;
  // 0 / 0 is 1 step: the maximum and the minimum leave a NaN out.
  const int steps = static_cast<int>(
      std::fmin(std::fmax(std::ceil(longestEdge(triangle) / spacing), 1.0), double{kMostSteps}));
  std::vector<glm::dvec3> points;
  for (int a = 0; a < steps; ++a) {
    for (int b = 0; a + b < steps; ++b) {
      points.push_back(p + (a + 1.0 / 3.0) / steps * (q - p) + (b + 1.0 / 3.0) / steps * (r - p));
    }
  }
  return points;
}

}  // namespace sherd
