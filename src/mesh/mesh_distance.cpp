// How far points are from a mesh, and on which side.
#include "mesh/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "mesh/nearest_on_triangle.h"
#include "mesh/winding_number.h"

namespace sherd {
namespace {

/// In a space where the mesh reaches from -1 to 1: more than single precision can be wrong about a
/// vertex, a point, or a box's distance (2^-24 each), relative and absolute.
constexpr double kMargin = 1e-6;

double halfOf(const Box& box) {
  const double half = 0.5 * longestSide(box);
  return half > 0.0 ? half : 1.0;
}

TriangleMesh normalised(const TriangleMesh& mesh, const glm::dvec3& middle, double half) {
  TriangleMesh result{{}, mesh.triangles};
  result.vertices.reserve(mesh.vertices.size());
  for (const glm::dvec3& v : mesh.vertices) result.vertices.push_back((v - middle) / half);
  return result;
}

struct Search {
  const TriangleMesh& mesh;
  glm::dvec3 point;
  double squared = std::numeric_limits<double>::infinity();
  glm::dvec3 nearest{0.0};
};

bool lookAt(RTCPointQueryFunctionArguments* found) {
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
      middle_(box_.min + 0.5 * (box_.max - box_.min)),
      half_(halfOf(box_)),
      body_(normalised(mesh, middle_, half_)),
      rays_(body_) {}

MeshDistance::Nearest MeshDistance::nearest(const glm::dvec3& world, double reach) const {
  Search search{body_, unitFrom(world)};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query{};
  const glm::vec3 at(search.point);
  query.x = at.x, query.y = at.y, query.z = at.z;
  query.radius = static_cast<float>(reach / half_ * (1.0 + kMargin) + kMargin);
  rtcPointQuery(rays_.scene(), &query, &context, &lookAt, &search);
  const double distance = std::sqrt(search.squared) * half_;
  if (!(distance <= reach)) return {std::numeric_limits<double>::infinity(), {}};
  return {distance, middle_ + half_ * search.nearest};
}

bool MeshDistance::contains(const glm::dvec3& world, double distance) const {
  const glm::dvec3 point = unitFrom(world);
  // Rays are right where single precision can tell the point from the surface.
  const std::optional<bool> told =
      distance > kMargin * half_ ? rays_.unanimous(point) : std::optional<bool>();
  return told ? *told : windingNumber(body_, point) > 0.5;
}

}  // namespace sherd
