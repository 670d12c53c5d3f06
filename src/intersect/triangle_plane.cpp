// Points in the plane of a triangle, projected along a coordinate axis.
#include "intersect/triangle_plane.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

namespace sherd {
namespace {

constexpr std::uint32_t kMortonCells = 1u << 16;  // per axis

// Moves bit i to bit 2i.
std::uint64_t spreadBits(std::uint32_t x) {
  std::uint64_t bits = x;
  bits = (bits | bits << 8) & 0x00ff00ffu;
  bits = (bits | bits << 4) & 0x0f0f0f0fu;
  bits = (bits | bits << 2) & 0x33333333u;
  return (bits | bits << 1) & 0x55555555u;
}

}  // namespace

TrianglePlane::TrianglePlane(std::span<const TrianglePoint> points) : points_(points) {
  const glm::dvec3 a = points[0].point.rounded;
  const glm::dvec3 size =
      glm::abs(glm::cross(points[1].point.rounded - a, points[2].point.rounded - a));
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int i, int j) { return size[i] > size[j]; });
  // The first but for triangles that are thin to the last digits.
  for (const int axis : axes) {
    axis_ = axis;
    side_ = sherd::orientation(points[0].point, points[1].point, points[2].point, axis);
    if (side_ != 0) return;
  }
}

bool TrianglePlane::isInCircle(std::uint32_t a, std::uint32_t b, std::uint32_t c,
                               std::uint32_t d) const {
  constexpr double kRounding = 1e-14;  // relative; a few dozen roundings
  const glm::dvec2 o = at(d), p = at(a) - o, q = at(b) - o, r = at(c) - o;
  const auto part = [](const glm::dvec2& apart, const glm::dvec2& u, const glm::dvec2& v) {
    const double square = glm::dot(apart, apart), left = u.x * v.y, right = u.y * v.x;
    return std::pair(square * (left - right), square * (std::abs(left) + std::abs(right)));
  };
  const auto [x, sizeX] = part(p, q, r);
  const auto [y, sizeY] = part(q, r, p);
  const auto [z, sizeZ] = part(r, p, q);
  return side_ * (x + y + z) > kRounding * (sizeX + sizeY + sizeZ);
}

std::vector<std::uint32_t> TrianglePlane::sorted() const {
  glm::dvec2 min = at(0), max = min;
  for (std::uint32_t i = 1; i < 3; ++i) min = glm::min(min, at(i)), max = glm::max(max, at(i));
  const glm::dvec2 cellsPerUnit = (kMortonCells - 1.0) / glm::max(max - min, 1e-300);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  for (auto i = std::uint32_t{3}; i < points_.size(); ++i) {
    const glm::dvec2 cell = glm::clamp((at(i) - min) * cellsPerUnit, 0.0, kMortonCells - 1.0);
    keys.emplace_back(spreadBits(static_cast<std::uint32_t>(cell.x)) |
                          spreadBits(static_cast<std::uint32_t>(cell.y)) << 1,
                      i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const auto& [key, i] : keys) order.push_back(i);
  return order;
}

}  // namespace sherd
