// Distance of points from a mesh, and their side.
#include "mesh/search/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "mesh/search/nearest_on_triangle.h"
#include "mesh/search/winding_number.h"

namespace sherd {
namespace {

/// For a mesh within -1..1: a bound of the relative and absolute rounding errors of single
/// precision for a vertex, a point and the distance of a box (2^-24 each).
constexpr double kMargin = 1e-6;

double halfOf(const Box& box) {
  const double half = 0.5 * longestSide(box);
  return half > 0.0 ? half : 1.0;
}

TriangleMesh normalized(const TriangleMesh& mesh, const glm::dvec3& center, double half) {
  TriangleMesh result{{}, mesh.triangles};
  result.vertices.reserve(mesh.vertices.size());
  for (const glm::dvec3& v : mesh.vertices) result.vertices.push_back((v - center) / half);
  return result;
}

struct Search {
  const TriangleMesh& mesh;
  glm::dvec3 point;
  double squared = std::numeric_limits<double>::infinity();
  glm::dvec3 nearest{0.0};
};

bool testTriangle(RTCPointQueryFunctionArguments* found) {
  Search& search = *static_cast<Search*>(found->userPtr);
  const glm::uvec3& t = search.mesh.triangles[found->primID];
  const std::vector<glm::dvec3>& v = search.mesh.vertices;
  const glm::dvec3 nearest = nearestOnTriangle(search.point, v[t.x], v[t.y], v[t.z]);
  const glm::dvec3 apart = search.point - nearest;
  const double squared = glm::dot(apart, apart);
  if (!(squared < search.squared)) return false;
  search.squared = squared;
  search.nearest = nearest;
  found->query->radius = std::min(
      found->query->radius, static_cast<float>(std::sqrt(squared) * (1.0 + kMargin) + kMargin));
  return true;
}

}  // namespace

MeshDistance::MeshDistance(const TriangleMesh& mesh)
    : box_(bounds(mesh)),
      center_(box_.min + 0.5 * (box_.max - box_.min)),
      half_(halfOf(box_)),
      unitMesh_(normalized(mesh, center_, half_)),
      rays_(unitMesh_) {}

MeshDistance::Nearest MeshDistance::nearest(const glm::dvec3& world, double reach) const {
  Search search{unitMesh_, unitFrom(world)};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query{};
  const glm::vec3 at(search.point);
  query.x = at.x, query.y = at.y, query.z = at.z;
  query.radius = static_cast<float>(reach / half_ * (1.0 + kMargin) + kMargin);
  rtcPointQuery(rays_.scene(), &query, &context, &testTriangle, &search);
  const double distance = std::sqrt(search.squared) * half_;
  if (!(distance <= reach)) return {std::numeric_limits<double>::infinity(), {}};
  return {distance, center_ + half_ * search.nearest};
}

bool MeshDistance::contains(const glm::dvec3& world, double distance) const {
  const glm::dvec3 point = unitFrom(world);
  // Rays are correct if single precision resolves the distance.
  const std::optional<bool> inside =
      distance > kMargin * half_ ? rays_.unanimous(point) : std::optional<bool>();
  return inside ? *inside : windingNumber(unitMesh_, point) > 0.5;
}

}  // namespace sherd
