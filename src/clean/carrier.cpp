// What of the mesh that was cut a vertex lies on.
#include "clean/carrier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace sherd {
namespace {

std::vector<glm::dvec3> waysWithin(const std::array<glm::dvec3, 3>& triangle) {
  const double oblique = std::sqrt(0.5);
  const glm::dvec3 u = glm::normalize(triangle[1] - triangle[0]);
  const glm::dvec3 normal = glm::cross(u, triangle[2] - triangle[0]);
  const glm::dvec3 v = glm::normalize(glm::cross(normal, u));
  const glm::dvec3 sum = oblique * (u + v), difference = oblique * (u - v);
  return {u, -u, v, -v, sum, -sum, difference, -difference};
}

}  // namespace

Carrier carrierOf(const Stars& stars, std::span<const std::uint32_t> faces) {
  Carrier carrier;
  for (const std::uint32_t f : faces) {
    if (stars.face(f).isOutside()) carrier.push_back(stars.face(f).source);
  }
  std::sort(carrier.begin(), carrier.end());
  carrier.erase(std::unique(carrier.begin(), carrier.end()), carrier.end());
  return carrier;
}

bool liesOn(const Carrier& own, const Carrier& other) {
  return std::includes(own.begin(), own.end(), other.begin(), other.end());
}

std::vector<glm::dvec3> waysAlong(const Carrier& carrier, const TriangleMesh& mesh) {
  if (carrier.empty()) {
    return {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  }
  const std::vector<glm::dvec3>& at = mesh.vertices;
  const glm::uvec3& first = mesh.triangles[carrier.front()];
  if (carrier.size() == 1) return waysWithin({at[first.x], at[first.y], at[first.z]});
  if (carrier.size() > 2) return {};
  const glm::uvec3& second = mesh.triangles[carrier.back()];
  std::vector<std::uint32_t> common;
  for (int k = 0; k < 3; ++k) {
    if (first[k] == second.x || first[k] == second.y || first[k] == second.z) {
      common.push_back(first[k]);
    }
  }
  if (common.size() != 2) return {};
  const glm::dvec3 along = glm::normalize(at[common[1]] - at[common[0]]);
  return {along, -along};
}

}  // namespace sherd
