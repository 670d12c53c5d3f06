// Sampling of a mesh's surface by area.
#include "mesh/surface_by_area.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sherd {
namespace {

glm::dvec3 scaledNormal(const TriangleMesh& mesh, std::size_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  const glm::dvec3& a = mesh.vertices[t.x];
  return glm::cross(mesh.vertices[t.y] - a, mesh.vertices[t.z] - a);
}

}  // namespace

SurfaceByArea::SurfaceByArea(const TriangleMesh& mesh) : mesh_(mesh) {
  sums_.reserve(mesh.triangles.size());
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    sums_.push_back(sum += 0.5 * glm::length(scaledNormal(mesh, t)));
  }
  if (!(sum > 0.0 && std::isfinite(sum))) {
    throw Error(ErrorCode::input,
                "the mesh has no area; points can be sampled only on a surface with area");
  }
}

// The first sum above share * area, so that the triangle's area is above 0.
std::size_t SurfaceByArea::triangleAt(double share) const {
  const auto at = std::upper_bound(sums_.begin(), sums_.end(), share * sums_.back());
  return static_cast<std::size_t>(at - sums_.begin());
}

// The square root maps the unit square to the triangle uniformly.
glm::dvec3 SurfaceByArea::pointIn(std::size_t triangle, double u, double v) const {
  const glm::uvec3& t = mesh_.triangles[triangle];
  const double root = std::sqrt(u);
  return (1.0 - root) * mesh_.vertices[t.x] + root * (1.0 - v) * mesh_.vertices[t.y] +
         root * v * mesh_.vertices[t.z];
}

glm::dvec3 SurfaceByArea::normalOf(std::size_t triangle) const {
  return glm::normalize(scaledNormal(mesh_, triangle));
}

}  // namespace sherd
