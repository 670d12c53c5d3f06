// Minimizes the quadratic error of tangent planes.
#include "surface/crease_point.h"

#include <openvdb/math/Mat3.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

constexpr double kRounding = 1e-6;

struct Eigen {
  double value = 0.0;
  glm::dvec3 vector{0.0};
};

// Eigenvalues and eigenvectors of the mean of n n^T, descending.
std::array<Eigen, 3> spreadOf(std::span<const TangentPlane> planes) {
  openvdb::math::Mat3d mean = openvdb::math::Mat3d::zero();
  for (const TangentPlane& plane : planes) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        mean(row, column) += plane.normal[row] * plane.normal[column];
    }
  }
  mean *= 1.0 / static_cast<double>(planes.size());
  openvdb::math::Mat3d vectors;
  openvdb::math::Vec3d values;
  openvdb::math::diagonalizeSymmetricMatrix(mean, vectors, values);
  std::array<Eigen, 3> all;
  for (int k = 0; k < 3; ++k) {
    all[static_cast<std::size_t>(k)] = {values[k], {vectors(0, k), vectors(1, k), vectors(2, k)}};
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Eigen& a, const Eigen& b) { return a.value > b.value; });
  return all;
}

// Moves a point along a line into a box, as little as possible; stays if the line misses the box.
glm::dvec3 slid(const glm::dvec3& from, const glm::dvec3& along, const PositionBox& box) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (int axis = 0; axis < 3; ++axis) {
    if (along[axis] == 0.0) continue;
    const double a = (box.low[axis] - from[axis]) / along[axis];
    const double b = (box.high[axis] - from[axis]) / along[axis];
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  return low <= high ? from + std::clamp(0.0, low, high) * along : from;
}

}  // namespace

CreasePoint creasePoint(std::span<const TangentPlane> planes, const glm::dvec3& mean,
                        const PositionBox& within) {
  const std::array<Eigen, 3> spread = spreadOf(planes);
  CreasePoint found{mean, 1};
  if (spread[1].value < kLeastEigenvalue) return {glm::clamp(mean, within.low, within.high)};
  found.rank = spread[2].value < kLeastEigenvalue ? 2 : 3;
  found.least = spread[static_cast<std::size_t>(found.rank) - 1].value;
  glm::dvec3 offsets(0.0);
  for (const TangentPlane& plane : planes)
    offsets += glm::dot(plane.normal, plane.point - mean) * plane.normal;
  offsets /= static_cast<double>(planes.size());
  for (int k = 0; k < found.rank; ++k) {
    const Eigen& eigen = spread[static_cast<std::size_t>(k)];
    found.at += glm::dot(eigen.vector, offsets) / eigen.value * eigen.vector;
  }
  if (found.rank == 2) found.at = slid(found.at, spread[2].vector, within);
  const glm::dvec3 clamped = glm::clamp(found.at, within.low, within.high);
  found.isClamped = glm::distance(clamped, found.at) > kRounding;
  found.at = clamped;
  return found;
}

}  // namespace sherd
