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

// Whether all normals are so near their mean that the surface is certainly smooth: of eigenvalues
// whose sum is 1, the second one is at most the rest of the spread along any direction.
bool isSmooth(std::span<const TangentPlane> planes) {
  constexpr double kSure = 0.99 * kLeastEigenvalue;
  glm::dvec3 sum(0.0);
  for (const TangentPlane& plane : planes) sum += plane.normal;
  const double length = glm::length(sum);
  if (length == 0.0) return false;
  double rest = 0.0;
  for (const TangentPlane& plane : planes) {
    const double along = glm::dot(plane.normal, sum) / length;
    rest += glm::dot(plane.normal, plane.normal) - along * along;
  }
  return rest < kSure * static_cast<double>(planes.size());
}

}  // namespace

CreaseFit::CreaseFit(std::span<const TangentPlane> planes, const glm::dvec3& mean) : at_(mean) {
  if (isSmooth(planes)) return;
  const std::array<Eigen, 3> spread = spreadOf(planes);
  if (spread[1].value < kLeastEigenvalue) return;
  rank_ = spread[2].value < kLeastEigenvalue ? 2 : 3;
  least_ = spread[static_cast<std::size_t>(rank_) - 1].value;
  along_ = spread[2].vector;
  glm::dvec3 offsets(0.0);
  for (const TangentPlane& plane : planes)
    offsets += glm::dot(plane.normal, plane.point - mean) * plane.normal;
  offsets /= static_cast<double>(planes.size());
  for (int k = 0; k < rank_; ++k) {
    const Eigen& eigen = spread[static_cast<std::size_t>(k)];
    at_ += glm::dot(eigen.vector, offsets) / eigen.value * eigen.vector;
  }
}

CreasePoint CreaseFit::within(const PositionBox& box) const {
  if (rank_ == 1) return {glm::clamp(at_, box.low, box.high)};
  const glm::dvec3 at = rank_ == 2 ? slid(at_, along_, box) : at_;
  const glm::dvec3 clamped = glm::clamp(at, box.low, box.high);
  return {clamped, rank_, glm::distance(clamped, at) > kRounding, least_};
}

}  // namespace sherd
