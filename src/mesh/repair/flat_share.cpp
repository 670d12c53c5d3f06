// Samples a surface at equal steps of area.
#include "mesh/repair/flat_share.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <vector>

#include "base/random.h"
#include "mesh/surface_by_area.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr int kFaceSamples = 1000;

// The normal of a triangle with a height below this share of its longest edge is rounding error.
constexpr double kLeastHeight = 1e-3;

bool isParallel(const std::array<glm::dvec3, 3>& t, const glm::dvec3& normal) {
  const glm::dvec3 own = areaNormal(t);
  const double twiceArea = glm::length(own);
  return isThin(t, twiceArea, kLeastHeight) ||
         std::abs(glm::dot(own, normal)) >= kSamePlaneCosine * twiceArea;
}

bool isFlatAround(const TriangleTree& tree, const glm::dvec3& point, const glm::dvec3& normal,
                  double reach) {
  const std::vector<std::uint32_t> near = tree.meeting({point - reach, point + reach});
  return std::all_of(near.begin(), near.end(), [&](std::uint32_t triangle) {
    return tree.squaredTo(point, triangle) > reach * reach ||
           isParallel(tree.corners(triangle), normal);
  });
}

}  // namespace

double flatShare(const TriangleTree& tree, double reach) {
  std::vector<double> areas;
  areas.reserve(tree.count());
  for (std::size_t t = 0; t < tree.count(); ++t) {
    const std::array<glm::dvec3, 3> corner = tree.corners(t);
    addArea(areas, 0, corner[0], corner[1], corner[2]);
  }
  if (areas.empty() || areas.back() == 0.0) return 0.0;
  const SurfaceByArea surface(SurfaceParts{
      {areas}, [&](std::size_t, std::size_t t) { return SurfaceTriangle{tree.corners(t)}; }});
  int flat = 0;
  for (std::uint64_t i = 0; i < kFaceSamples; ++i) {
    const SurfaceTriangle triangle =
        surface.at(surface.triangleAt((static_cast<double>(i) + 0.5) / kFaceSamples));
    const glm::dvec3 point = triangle.pointIn(randomUnit(0, Stage::flatPoint, 2 * i),
                                              randomUnit(0, Stage::flatPoint, 2 * i + 1));
    if (isFlatAround(tree, point, triangle.normal(), reach)) ++flat;
  }
  return static_cast<double>(flat) / kFaceSamples;
}

}  // namespace sherd
