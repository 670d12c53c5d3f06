// Convexity of a mesh, and the effective number of fragments.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "base/cancel_flag.h"
#include "base/random.h"
#include "evaluate/convexity_rays.h"
#include "mesh/hull.h"
#include "mesh/search/inside.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

constexpr double kPush = 1e-4;               // of the diagonal of the points' box
constexpr std::size_t kPointsPerCheck = 64;  // points between checks for cancellation

struct SurfacePoint {
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};  ///< unit, or zero where the adjacent normals cancel
};

/// Returns the mesh moved to the mean of its vertices and scaled to a largest absolute coordinate
/// of 1.
TriangleMesh normalized(const TriangleMesh& mesh) {
  TriangleMesh result{mesh.vertices, mesh.triangles};
  const double share = 1.0 / static_cast<double>(mesh.vertices.size());
  glm::dvec3 mean(0.0);
  for (const glm::dvec3& v : mesh.vertices) mean += share * v;
  double largest = 0.0;
  for (glm::dvec3& v : result.vertices) {
    v -= mean;
    largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  }
  if (!(largest > 0.0 && std::isfinite(largest))) {
    throw Error(ErrorCode::input, "the mesh has no area; a closed mesh is needed");
  }
  for (glm::dvec3& v : result.vertices) v /= largest;
  return result;
}

/// Prefix sums of twice the triangles' areas, [triangles].
std::vector<double> areaSums(const TriangleMesh& mesh) {
  std::vector<double> sums;
  sums.reserve(mesh.triangles.size());
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3& a = mesh.vertices[t.x];
    sums.push_back(sum += glm::length(glm::cross(mesh.vertices[t.y] - a, mesh.vertices[t.z] - a)));
  }
  return sums;
}

std::vector<SurfacePoint> sampleSurface(const TriangleMesh& mesh, std::size_t count,
                                        std::uint64_t seed) {
  const std::vector<double> sums = areaSums(mesh);
  if (!(sums.back() > 0.0)) {
    throw Error(ErrorCode::input, "the mesh has no area; a closed mesh is needed");
  }
  const std::vector<glm::dvec3> normals = vertexNormals(mesh);
  const auto draw = [&](std::size_t item) {  // uniform in [0, 1)
    return randomUnit(seed, Stage::convexitySample, item);
  };
  std::vector<SurfacePoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = std::upper_bound(sums.begin(), sums.end(), draw(3 * i) * sums.back());
    const glm::uvec3& t =
        mesh.triangles[std::min(static_cast<std::size_t>(at - sums.begin()), sums.size() - 1)];
    // The square root maps uniform points of the unit square to uniform points of the triangle.
    const double root = std::sqrt(draw(3 * i + 1)), split = draw(3 * i + 2);
    const double x = 1.0 - root, y = root * (1.0 - split), z = root * split;
    points[i] = {x * mesh.vertices[t.x] + y * mesh.vertices[t.y] + z * mesh.vertices[t.z],
                 unitOrZero(x * normals[t.x] + y * normals[t.y] + z * normals[t.z])};
  }
  return points;
}

double boxDiagonal(const std::vector<SurfacePoint>& points) {
  glm::dvec3 low = points.front().position, high = low;
  for (const SurfacePoint& point : points) {
    low = glm::min(low, point.position);
    high = glm::max(high, point.position);
  }
  return glm::length(high - low);
}

}  // namespace

Convexity convexityFrom(std::span<const double> distances) {
  Convexity result;
  double sum = 0.0;
  for (const double d : distances) {
    if (d < 0.0) continue;
    sum += d;
    ++result.samples;
  }
  if (result.samples == 0) {
    throw Error(ErrorCode::input,
                "no point of the surface has the inside below it; "
                "a closed mesh oriented outwards is needed");
  }
  const double count = static_cast<double>(result.samples), mean = sum / count;
  double squares = 0.0;
  for (const double d : distances) squares += d < 0.0 ? 0.0 : (d - mean) * (d - mean);
  result.value = 1.0 - mean;
  result.standardDeviation = std::sqrt(squares / count);
  return result;
}

ConvexityRays convexityRays(const TriangleMesh& mesh, std::size_t samples, std::uint64_t seed) {
  if (samples == 0) throw Error(ErrorCode::usage, "convexity: 0 samples, expected at least 1");
  if (mesh.triangles.empty()) {
    throw Error(ErrorCode::input, "the mesh has no area; a closed mesh is needed");
  }
  ConvexityRays result{normalized(mesh), {}};
  const std::vector<SurfacePoint> points = sampleSurface(result.mesh, samples, seed);
  const double push = kPush * boxDiagonal(points);
  for (const SurfacePoint& point : points) {
    if (point.normal == glm::dvec3(0.0)) continue;
    result.rays.push_back({point.position - push * point.normal, point.normal});
  }
  return result;
}

Convexity convexity(const TriangleMesh& mesh, std::size_t samples, std::uint64_t seed,
                    const Progress* progress) {
  throwIfCancelled(progress);
  const ConvexityRays sampled = convexityRays(mesh, samples, seed);
  const std::vector<ConvexityRays::Ray>& rays = sampled.rays;
  const std::vector<HalfSpace> hull = convexHull(sampled.mesh.vertices);
  const InsideTest inside(sampled.mesh);
  std::vector<double> distances(rays.size(), -1.0);  // below 0: not measured
  tbb::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t i) {
    if (i % kPointsPerCheck == 0) throwIfCancelled(progress);
    if (!inside.contains(rays[i].origin)) return;
    distances[i] = exitDistance(hull, rays[i].origin, rays[i].direction);
  });
  return convexityFrom(distances);
}

double effectiveCount(std::span<const double> shares) {
  double sum = 0.0, squares = 0.0;
  for (const double share : shares) {
    sum += share;
    squares += share * share;
  }
  return squares > 0.0 ? sum * sum / squares : 0.0;
}

}  // namespace sherd
