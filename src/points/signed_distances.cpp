// How far points are from a mesh, and on which side.
//
// Embree's tree finds the triangles that may be nearest, in single precision with a margin; how far
// each is, is told in double precision, and the least of them does not depend on the tree.
#include <sherd/points.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "evaluate/inside.h"
#include "mesh/winding_number.h"
#include "points/nearest_on_triangle.h"

namespace sherd {
namespace {

/// In a space where the mesh reaches from -1 to 1: more than single precision can be wrong about a
/// vertex, a point, or a box's distance (2^-24 each), relative and absolute.
constexpr double kMargin = 1e-6;

/// The mesh about the middle of its box, half the longest side being 1.
struct Unit {
  glm::dvec3 middle;
  double half;

  explicit Unit(const TriangleMesh& mesh) {
    const Box box = bounds(mesh);
    const glm::dvec3 side = box.max - box.min;
    middle = box.min + 0.5 * side;
    half = 0.5 * std::max({side.x, side.y, side.z});
    if (!(half > 0.0)) half = 1.0;
  }
  glm::dvec3 from(const glm::dvec3& world) const { return (world - middle) / half; }
};

TriangleMesh normalised(const TriangleMesh& mesh, const Unit& unit) {
  TriangleMesh result{{}, mesh.triangles};
  result.vertices.reserve(mesh.vertices.size());
  for (const glm::dvec3& v : mesh.vertices) result.vertices.push_back(unit.from(v));
  return result;
}

struct Nearest {
  const TriangleMesh& mesh;
  glm::dvec3 point;
  double squared = std::numeric_limits<double>::infinity();
};

bool lookAt(RTCPointQueryFunctionArguments* found) {
  Nearest& nearest = *static_cast<Nearest*>(found->userPtr);
  const glm::uvec3& t = nearest.mesh.triangles[found->primID];
  const std::vector<glm::dvec3>& v = nearest.mesh.vertices;
  const glm::dvec3 apart = nearest.point - nearestOnTriangle(nearest.point, v[t.x], v[t.y], v[t.z]);
  const double squared = glm::dot(apart, apart);
  if (!(squared < nearest.squared)) return false;
  nearest.squared = squared;
  found->query->radius = static_cast<float>(std::sqrt(squared) * (1.0 + kMargin) + kMargin);
  return true;
}

double distanceTo(const TriangleMesh& mesh, RTCScene scene, const glm::dvec3& point) {
  Nearest nearest{mesh, point};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query{};
  const glm::vec3 at(point);
  query.x = at.x, query.y = at.y, query.z = at.z;
  query.radius = std::numeric_limits<float>::infinity();
  rtcPointQuery(scene, &query, &context, &lookAt, &nearest);
  return std::sqrt(nearest.squared);
}

}  // namespace

std::vector<double> signedDistances(const TriangleMesh& mesh, std::span<const glm::dvec3> points,
                                    const Progress* progress) {
  const Unit unit(mesh);
  const TriangleMesh body = normalised(mesh, unit);
  const InsideTest rays(body);

  std::vector<double> distances(points.size());
  const auto measure = [&](std::size_t i) {
    const glm::dvec3 point = unit.from(points[i]);
    const double distance = distanceTo(body, rays.scene(), point);
    // Rays are right where single precision can tell the point from the surface.
    const std::optional<bool> told =
        distance > kMargin ? rays.unanimous(point) : std::optional<bool>();
    const bool inside = told ? *told : windingNumber(body, point) > 0.5;
    distances[i] = (inside ? -distance : distance) * unit.half;
  };
  // In rounds, so that the caller's thread can report and be stopped between them.
  constexpr std::size_t kRound = 65536;
  for (std::size_t first = 0; first < points.size(); first += kRound) {
    step(progress, "distances", static_cast<double>(first) / static_cast<double>(points.size()));
    tbb::parallel_for(first, std::min(first + kRound, points.size()), measure);
  }
  return distances;
}

}  // namespace sherd
