// Triangles near some voxels, each bounded by a disc.
#include "voxelize/discs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace sherd {
namespace {

// Rounding to single precision moves a disc or a point by less than this fraction of its distance
// from the origin plus its size; query points are within kMaxPointDistance of the origin.
constexpr double kRounding = 1e-6;
constexpr double kMaxPointDistance = 32.0;

// The normal of a triangle with a smaller angle than this is not used.
constexpr double kLeastSine = 1e-6;

// These factors exceed the effect of a few roundings.
constexpr float kUp = 1.0f + 2e-6f, kDown = 1.0f - 2e-6f;

}  // namespace

void Discs::assign(const TriangleTree& tree, const glm::dvec3& origin,
                   std::span<const std::uint32_t> triangles) {
  tree_ = &tree;
  origin_ = origin;
  triangles_.assign(triangles.begin(), triangles.end());
  for (std::vector<float>& column : columns_) column.resize(triangles.size());
  ownEdges_.resize(triangles.size());
  edges_ = ownEdges_.data();
  number_.resize(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::array<glm::dvec3, 3> t = tree.corners(triangles[i]);
    const glm::dvec3 center = (t[0] + t[1] + t[2]) / 3.0;
    const glm::dvec3 along = t[1] - t[0], beside = t[2] - t[0], across = glm::cross(along, beside);
    const double twice = glm::length(across);
    // Of corners in a line the rounding errors have any direction, even along it.
    const bool isFlat = twice > kLeastSine * glm::length(along) * glm::length(beside);
    const glm::dvec3 normal = isFlat ? across / twice : glm::dvec3(0.0);
    double squared = 0.0;
    for (const glm::dvec3& v : t) squared = std::max(squared, glm::dot(v - center, v - center));
    const double radius = std::sqrt(squared);
    const glm::dvec3 from = center - origin;
    const double slack = kRounding * (glm::length(from) + radius + kMaxPointDistance);
    const std::array<double, kColumns> values{from.x,   from.y,   from.z,         normal.x,
                                              normal.y, normal.z, radius + slack, slack};
    for (std::size_t k = 0; k < values.size(); ++k) columns_[k][i] = static_cast<float>(values[k]);
    ownEdges_[i] = edgesOf(t, center, normal);
    number_[i] = static_cast<std::uint32_t>(i);
  }
}

void Discs::assign(Discs& others, double reach) {
  tree_ = others.tree_;
  origin_ = others.origin_;
  const std::span<const std::uint32_t> chosen =
      others.below(static_cast<float>(reach * reach) * kUp);
  const auto take = [&](auto& to, const auto& from) {
    to.resize(chosen.size());
    for (std::size_t k = 0; k < chosen.size(); ++k) to[k] = from[chosen[k]];
  };
  take(triangles_, others.triangles_);
  edges_ = others.edges_;
  take(number_, others.number_);
  for (std::size_t k = 0; k < columns_.size(); ++k) take(columns_[k], others.columns_[k]);
}

// Combines a point's distance from each disc's plane with its distance beyond the disc's edge.
void Discs::measure(const glm::dvec3& point) {
  const glm::vec3 p(point - origin_);
  const std::size_t count = triangles_.size();
  squared_.resize(count);
  const float *x = columns_[kX].data(), *y = columns_[kY].data(), *z = columns_[kZ].data();
  const float *normalX = columns_[kNormalX].data(), *normalY = columns_[kNormalY].data(),
              *normalZ = columns_[kNormalZ].data();
  const float *radius = columns_[kRadius].data(), *slack = columns_[kSlack].data();
  float* out = squared_.data();
  for (std::size_t i = 0; i < count; ++i) {
    const float qx = p.x - x[i], qy = p.y - y[i], qz = p.z - z[i];
    const float height = std::abs(qx * normalX[i] + qy * normalY[i] + qz * normalZ[i]);
    const float most = height + slack[i], least = height - slack[i];
    const float rest = (qx * qx + qy * qy + qz * qz) * kDown - most * most;
    const float beside = std::sqrt(rest > 0.0f ? rest : 0.0f) - radius[i];
    const float above = least > 0.0f ? least : 0.0f, outside = beside > 0.0f ? beside : 0.0f;
    out[i] = (above * above + outside * outside) * kDown;
  }
}

Discs::Edges Discs::edgesOf(const std::array<glm::dvec3, 3>& t, const glm::dvec3& center,
                            const glm::dvec3& normal) {
  Edges edges;
  for (std::size_t k = 0; k < 4; ++k) {
    const glm::dvec3 &a = t[std::min<std::size_t>(k, 2)], &b = t[k < 2 ? k + 1 : 0];
    const glm::dvec3 across = glm::cross(b - a, normal);
    const double length = glm::length(across);
    const glm::dvec3 outwards = length > 0.0 ? across / length : glm::dvec3(0.0);
    edges.normalX[k] = static_cast<float>(outwards.x);
    edges.normalY[k] = static_cast<float>(outwards.y);
    edges.normalZ[k] = static_cast<float>(outwards.z);
    edges.offset[k] = static_cast<float>(glm::dot(outwards, a - center));
  }
  return edges;
}

// Combines a point's distance from a triangle's plane with that beyond the farthest of its edges,
// if that bound is higher.
inline void Discs::narrow(const glm::vec3& p, std::uint32_t index) {
  const Edges& edges = edges_[number_[index]];
  const float x = p.x - columns_[kX][index], y = p.y - columns_[kY][index],
              z = p.z - columns_[kZ][index];
  const Floats beyond = edges.normalX * x + edges.normalY * y + edges.normalZ * z - edges.offset;
  const float slack = columns_[kSlack][index];
  const float outside =
      std::max(std::max(beyond[0], beyond[1]), beyond[2]) - 2.0f * slack;  // of point and edges
  if (!(outside > 0.0f)) return;
  const float height = std::abs(x * columns_[kNormalX][index] + y * columns_[kNormalY][index] +
                                z * columns_[kNormalZ][index]);
  const float above = std::max(height - slack, 0.0f);
  squared_[index] = std::max(squared_[index], (above * above + outside * outside) * kDown);
}

// Returns the indices of triangles whose squared distance to the last point may be below `limit`.
std::span<std::uint32_t> Discs::below(float limit) {
  chosen_.resize(triangles_.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    chosen_[count] = static_cast<std::uint32_t>(i);
    count += squared_[i] < limit ? 1 : 0;
  }
  return std::span(chosen_).first(count);
}

TriangleTree::Nearest Discs::nearest(const glm::dvec3& point, double reach, std::uint32_t guess) {
  TriangleTree::Nearest found;
  double squared = reach * reach;
  const auto test = [&](std::uint32_t triangle) {
    const double own = tree_->squaredTo(point, triangle);
    if (!(own < squared)) return;
    squared = own;
    found = {std::sqrt(own), triangle};
  };
  if (guess != TriangleTree::kNone) test(guess);
  measure(point);
  const std::span<std::uint32_t> near = below(static_cast<float>(squared) * kUp);
  if (near.empty()) return found;
  const glm::vec3 p(point - origin_);
  for (const std::uint32_t i : near) narrow(p, i);
  const auto closer = [&](std::uint32_t a, std::uint32_t b) { return squared_[a] < squared_[b]; };
  std::swap(near[0], *std::min_element(near.begin(), near.end(), closer));  // prunes most others
  for (const std::uint32_t i : near) {
    if (squared_[i] < static_cast<float>(squared) * kUp && triangles_[i] != found.triangle)
      test(triangles_[i]);
  }
  return found;
}

}  // namespace sherd
