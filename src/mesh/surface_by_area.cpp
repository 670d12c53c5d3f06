// Sampling of a surface by area.
#include "mesh/surface_by_area.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "mesh/triangle_area.h"

namespace sherd {
namespace {

// Returns the index of the first sum above `area`, as std::upper_bound does, without branches that
// depend on the sums: no processor predicts those of a random area.
std::size_t firstSumAbove(std::span<const double> sums, double area) {
  const double* first = sums.data();
  std::size_t count = sums.size();
  while (count > 1) {
    const std::size_t half = count / 2;
    first += half * static_cast<std::size_t>(first[half - 1] <= area);
    count -= half;
  }
  return static_cast<std::size_t>(first - sums.data()) + (count == 1 && *first <= area ? 1 : 0);
}

}  // namespace

void addArea(std::vector<double>& areaSums, std::size_t firstOfPart, const glm::dvec3& a,
             const glm::dvec3& b, const glm::dvec3& c) {
  const double sum = areaSums.size() > firstOfPart ? areaSums.back() : 0.0;
  areaSums.push_back(sum + areaOf({a, b, c}));
}

// The square root maps the unit square to the triangle uniformly.
glm::dvec3 SurfaceTriangle::pointIn(double u, double v) const {
  const auto [a, b, c] = sharesAt(u, v);
  return a * corner[0] + b * corner[1] + c * corner[2];
}

std::array<double, 3> SurfaceTriangle::sharesAt(double u, double v) {
  const double root = std::sqrt(u);
  return {1.0 - root, root * (1.0 - v), root * v};
}

glm::dvec3 SurfaceTriangle::normal() const { return glm::normalize(areaNormal(corner)); }

SurfaceByArea::SurfaceByArea(const TriangleMesh& mesh) {
  std::vector<double> sums;
  sums.reserve(mesh.triangles.size());
  double sum = 0.0;  // as addArea() sums, without reading each sum back
  for (const glm::uvec3& t : mesh.triangles) {
    sum += areaOf({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]});
    sums.push_back(sum);
  }
  parts_.ownSums = std::move(sums);
  parts_.areaSums = {parts_.ownSums};
  parts_.triangle = [&mesh](std::size_t, std::size_t triangle) {
    const glm::uvec3& t = mesh.triangles[triangle];
    return SurfaceTriangle{{mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]},
                           mesh.neighborOf(triangle)};
  };
  addParts();
}

SurfaceByArea::SurfaceByArea(SurfaceParts parts) : parts_(std::move(parts)) { addParts(); }

void SurfaceByArea::addParts() {
  double area = 0.0;
  std::size_t triangles = 0;
  for (const std::span<const double> sums : parts_.areaSums) {
    partSums_.push_back(area += sums.empty() ? 0.0 : sums.back());
    ends_.push_back(triangles += sums.size());
  }
  if (!std::isfinite(area)) {
    throw Error(ErrorCode::input,
                "the area of the mesh is not a finite number; points can be sampled only on a "
                "surface with a finite area");
  }
  if (!(area > 0.0)) {
    throw Error(ErrorCode::input,
                "the mesh has no area; points can be sampled only on a surface with area");
  }
}

SurfaceByArea::Index SurfaceByArea::indexOf(std::size_t triangle) const {
  const auto part = static_cast<std::size_t>(
      std::upper_bound(ends_.begin(), ends_.end(), triangle) - ends_.begin());
  return {part, triangle - (part == 0 ? 0 : ends_[part - 1])};
}

double SurfaceByArea::area(std::size_t triangle) const {
  const Index index = indexOf(triangle);
  const std::span<const double> sums = parts_.areaSums[index.part];
  return index.triangle == 0 ? sums[0] : sums[index.triangle] - sums[index.triangle - 1];
}

SurfacePoint SurfaceByArea::pointAt(std::size_t triangle, double u, double v) const {
  const Index index = indexOf(triangle);
  const SurfaceTriangle t = parts_.triangle(index.part, index.triangle);
  SurfacePoint point{t.pointIn(u, v), t.normal(), t.neighbor};
  if (parts_.displace)
    parts_.displace(index.part, index.triangle, SurfaceTriangle::sharesAt(u, v), point);
  return point;
}

// The first sum above the area, so that the triangle's area is above 0.  Rounding may leave none.
std::size_t SurfaceByArea::triangleAt(double share) const {
  const auto firstAbove = [](std::span<const double> sums, double area) {
    const std::size_t found = firstSumAbove(sums, area);
    if (found < sums.size()) return found;
    return static_cast<std::size_t>(std::lower_bound(sums.begin(), sums.end(), sums.back()) -
                                    sums.begin());
  };
  const double area = share * partSums_.back();
  const std::size_t part = firstAbove(partSums_, area);
  if (part == 0) return firstAbove(parts_.areaSums[0], area);
  return ends_[part - 1] + firstAbove(parts_.areaSums[part], area - partSums_[part - 1]);
}

}  // namespace sherd
