// Classifies triangles by the nearest other fragment.
#include "evaluate/distance_neighbors.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <map>

#include "base/cancel_flag.h"
#include "evaluate/assembly.h"
#include "evaluate/cracks/triangle_points.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

/// Returns the index of the fragment behind a point of fragment i, or kNone.
std::size_t behind(const Assembly& assembly, std::size_t i, const glm::dvec3& point,
                   const glm::dvec3& normal, double tolerance, double rounding) {
  const Assembly::Location at = assembly.locate(point, i, rounding);
  if (at.nearest == Assembly::kNone) return Assembly::kNone;
  if (at.depth > 0.0 || at.distance <= rounding) return at.nearest;
  constexpr double kCosine = 0.5;  // of 60 degrees, as in fit()
  const bool faces = glm::dot(normal, at.closestPoint - point) >= kCosine * at.distance;
  return faces && at.distance <= tolerance ? at.nearest : Assembly::kNone;
}

BehindTriangles classify(const Assembly& assembly, std::size_t i, double tolerance, double rounding,
                         double spacing, const Progress* progress) {
  const TriangleMesh& mesh = assembly.fragment(i).mesh;
  BehindTriangles result;
  std::map<int, double> areas;
  for (const glm::uvec3& t : mesh.triangles) {
    throwIfCancelled(progress);
    const std::array<glm::dvec3, 3> p{mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]};
    const double size = areaOf(p);
    const glm::dvec3 normal = size > 0.0 ? areaNormal(p) / (2.0 * size) : glm::dvec3(0.0);
    std::map<int, int> votes;
    const std::vector<glm::dvec3> points = pointsOn(p, spacing);
    for (const glm::dvec3& point : points) {
      const std::size_t other = behind(assembly, i, point, normal, tolerance, rounding);
      ++votes[other == Assembly::kNone ? 0 : assembly.fragment(other).id];
    }
    for (const auto& [id, count] : votes) {
      if (id != 0) areas[id] += size * count / static_cast<double>(points.size());
    }
    const auto most =
        std::max_element(votes.begin(), votes.end(),
                         [](const auto& x, const auto& y) { return x.second < y.second; });
    result.neighbor.push_back(static_cast<std::uint16_t>(most->first));
  }
  result.areas.assign(areas.begin(), areas.end());
  return result;
}

}  // namespace

std::vector<BehindTriangles> neighborsByDistance(std::span<const FragmentMesh> fragments,
                                                 double tolerance, double spacing,
                                                 const Progress* progress) {
  const Assembly assembly(fragments);
  const double diagonal = glm::length(assembly.box().max - assembly.box().min);
  std::vector<BehindTriangles> result(fragments.size());
  tbb::parallel_for(std::size_t{0}, fragments.size(), [&](std::size_t i) {
    result[i] = classify(assembly, i, tolerance * diagonal, Assembly::kRounding * diagonal, spacing,
                         progress);
  });
  return result;
}

}  // namespace sherd
