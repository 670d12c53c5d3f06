// Rasterizes cracks and correlates their heights.
#include "evaluate/cracks/heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

namespace sherd {
namespace {

constexpr double kMostNodes = 67108864.0;
constexpr int kLeastLag = 4;          // nodes, of a slope
constexpr double kGreatestLag = 0.1;  // of the length, of a slope
constexpr double kLongestLag = 0.25;  // of the length
constexpr std::size_t kLeastLags = 4;
constexpr double kLeastPairs = 0.05;  // of the nodes

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// A corner of a triangle: position in nodes, and height.
using Corner = glm::dvec3;

double cross(const Corner& a, const Corner& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

void raster(HeightGrid& grid, const std::array<Corner, 3>& t) {
  const double twice = cross(t[0], t[1], t[2].x, t[2].y);
  if (twice == 0.0) return;
  const auto [left, right] = std::minmax({t[0].x, t[1].x, t[2].x});
  const auto [low, high] = std::minmax({t[0].y, t[1].y, t[2].y});
  for (int v = std::max(0, static_cast<int>(std::ceil(low)));
       v <= std::min(grid.down - 1, static_cast<int>(std::floor(high))); ++v) {
    for (int u = std::max(0, static_cast<int>(std::ceil(left)));
         u <= std::min(grid.across - 1, static_cast<int>(std::floor(right))); ++u) {
      const double a = cross(t[1], t[2], u, v) / twice, b = cross(t[2], t[0], u, v) / twice;
      const double c = 1.0 - a - b;
      if (std::min({a, b, c}) < -1e-9) continue;
      const auto height = static_cast<float>(a * t[0].z + b * t[1].z + c * t[2].z);
      float& known =
          grid.height[static_cast<std::size_t>(v) * static_cast<std::size_t>(grid.across) +
                      static_cast<std::size_t>(u)];
      if (!(known >= height)) known = height;
    }
  }
}

/// The mean square difference at a lag, and the number of pairs.
std::pair<double, std::size_t> differences(const HeightGrid& grid, int lag) {
  double sum = 0.0;
  std::size_t pairs = 0;
  for (int v = 0; v < grid.down; ++v) {
    for (int u = 0; u + lag < grid.across; ++u) {
      const float difference = grid.at(u + lag, v) - grid.at(u, v);
      if (std::isnan(difference)) continue;
      sum += static_cast<double>(difference) * static_cast<double>(difference);
      ++pairs;
    }
  }
  return {pairs > 0 ? sum / static_cast<double>(pairs) : 0.0, pairs};
}

std::optional<double> slopeOf(const std::vector<glm::dvec2>& logarithms) {
  if (logarithms.size() < kLeastLags) return {};
  glm::dvec2 mean(0.0);
  for (const glm::dvec2& p : logarithms) mean += p / static_cast<double>(logarithms.size());
  double squares = 0.0, products = 0.0;
  for (const glm::dvec2& p : logarithms) {
    squares += (p.x - mean.x) * (p.x - mean.x);
    products += (p.x - mean.x) * (p.y - mean.y);
  }
  return products / squares;
}

}  // namespace

std::optional<HeightGrid> heightsOver(const TriangleMesh& mesh,
                                      std::span<const std::uint32_t> triangles,
                                      const FittedPlane& plane, const glm::dvec3& u,
                                      double spacing) {
  const glm::dvec3 v = glm::cross(plane.normal, u);
  const auto project = [&](std::uint32_t vertex) {
    const glm::dvec3& p = mesh.vertices[vertex];
    return Corner{glm::dot(p, u) / spacing, glm::dot(p, v) / spacing,
                  glm::dot(p, plane.normal) - plane.offset};
  };
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const std::uint32_t t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 at(project(mesh.triangles[t][k]));
      low = glm::min(low, at);
      high = glm::max(high, at);
    }
  }
  if (triangles.empty()) return {};
  low = glm::floor(low);
  const glm::dvec2 size = glm::floor(high - low) + 1.0;
  if (!(size.x * size.y <= kMostNodes)) return {};
  HeightGrid grid{static_cast<int>(size.x), static_cast<int>(size.y), spacing};
  grid.height.assign(static_cast<std::size_t>(size.x * size.y), kNone);
  for (const std::uint32_t t : triangles) {
    std::array<Corner, 3> corners;
    for (int k = 0; k < 3; ++k) {
      corners[static_cast<std::size_t>(k)] = project(mesh.triangles[t][k]) - Corner(low, 0.0);
    }
    raster(grid, corners);
  }
  return grid;
}

Correlation correlationAlong(const HeightGrid& grid) {
  Correlation result;
  std::vector<glm::dvec2> logarithms;
  const double nodes = static_cast<double>(grid.across) * static_cast<double>(grid.down);
  int before = 0;
  for (double exact = 1.0; exact <= kLongestLag * grid.across; exact *= std::sqrt(2.0)) {
    const int lag = static_cast<int>(std::lround(exact));
    if (lag == before) continue;
    before = lag;
    const auto [square, pairs] = differences(grid, lag);
    if (static_cast<double>(pairs) < kLeastPairs * nodes || !(square > 0.0)) continue;
    result.lags.push_back(lag * grid.spacing);
    result.values.push_back(std::sqrt(square));
    if (lag < kLeastLag || lag > kGreatestLag * grid.across) continue;
    logarithms.emplace_back(std::log(lag), 0.5 * std::log(square));
  }
  result.slope = slopeOf(logarithms);
  return result;
}

}  // namespace sherd
