// Minimizes the quadratic error of tangent planes.
#include "interface/cells/crease_point.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "mesh/symmetric_eigen.h"

namespace sherd {
namespace {

constexpr double kRounding = 1e-6;

// Eigenvalues and eigenvectors of the mean of n n^T, descending.
SymmetricEigen spreadOf(std::span<const TangentPlane> planes) {
  glm::dmat3 mean(0.0);
  for (const TangentPlane& plane : planes) mean += glm::outerProduct(plane.normal, plane.normal);
  mean *= 1.0 / static_cast<double>(planes.size());
  const SymmetricEigen found = fastEigenOf(mean);
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return found.values[a] > found.values[b]; });
  SymmetricEigen sorted;
  for (int k = 0; k < 3; ++k) {
    const auto to = static_cast<std::size_t>(k);
    sorted.values[k] = found.values[order[to]];
    sorted.vectors[to] = found.vectors[static_cast<std::size_t>(order[to])];
  }
  return sorted;
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
  const SymmetricEigen spread = spreadOf(planes);
  if (spread.values[1] < kLeastEigenvalue) return;
  rank_ = spread.values[2] < kLeastEigenvalue ? 2 : 3;
  least_ = spread.values[rank_ - 1];
  along_ = spread.vectors[2];
  glm::dvec3 offsets(0.0);
  for (const TangentPlane& plane : planes)
    offsets += glm::dot(plane.normal, plane.point - mean) * plane.normal;
  offsets /= static_cast<double>(planes.size());
  for (int k = 0; k < rank_; ++k) {
    const glm::dvec3& vector = spread.vectors[static_cast<std::size_t>(k)];
    at_ += glm::dot(vector, offsets) / spread.values[k] * vector;
  }
}

CreasePoint CreaseFit::within(const PositionBox& box) const {
  if (rank_ == 1) return {glm::clamp(at_, box.low, box.high)};
  const glm::dvec3 at = rank_ == 2 ? slid(at_, along_, box) : at_;
  const glm::dvec3 clamped = glm::clamp(at, box.low, box.high);
  return {clamped, rank_, glm::distance(clamped, at) > kRounding, least_};
}

}  // namespace sherd
