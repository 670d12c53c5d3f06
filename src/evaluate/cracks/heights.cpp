// Rasterizes cracks and correlates their heights.
#include "evaluate/cracks/heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

constexpr double kMostNodes = 67108864.0;
constexpr int kLeastLength = 30;      // nodes, of a slope
constexpr int kLeastLag = 4;          // nodes, of a slope
constexpr double kGreatestLag = 0.1;  // of the length, of a slope
constexpr double kShortLag = 10.0;    // nodes: of a slope also in a grid shorter than 10 times that
constexpr double kLongestLag = 0.25;  // of the length
constexpr std::size_t kLeastLags = 3;
constexpr double kLeastVariance = 1e-9;  // of a mean square: less of a variance is none
constexpr double kLeastPairs = 0.05;     // of the nodes

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

/// Differences of heights at several nodes of a line.
struct Differences {
  std::size_t count = 0;
  double mean = 0.0;
  double meanSquare = 0.0;
};

/// Takes a difference over all of a grid.
///   reach       nodes from the first to the last
///   difference  of the node (u, v) and those after it; NaN where one has no height
template <class Difference>
Differences differences(const HeightGrid& grid, int reach, Difference difference) {
  Differences result;
  for (int v = 0; v < grid.down; ++v) {
    for (int u = 0; u + reach < grid.across; ++u) {
      const double value = difference(u, v);
      if (std::isnan(value)) continue;
      result.mean += value;
      result.meanSquare += value * value;
      ++result.count;
    }
  }
  if (result.count == 0) return result;
  result.mean /= static_cast<double>(result.count);
  result.meanSquare /= static_cast<double>(result.count);
  return result;
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
  HeightGrid grid{static_cast<int>(size.x), static_cast<int>(size.y), spacing, low};
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

namespace {

/// Returns lags of up to so many nodes, by factors of sqrt 2.
std::vector<int> lagsTo(double most) {
  std::vector<int> lags;
  for (double exact = 1.0; exact <= most; exact *= std::sqrt(2.0)) {
    const int lag = static_cast<int>(std::lround(exact));
    if (lags.empty() || lags.back() != lag) lags.push_back(lag);
  }
  return lags;
}

std::optional<double> slopeAlong(const HeightGrid& grid, std::size_t leastPairs) {
  if (grid.across < kLeastLength) return {};
  std::vector<glm::dvec2> logarithms;
  for (const int lag : lagsTo(std::max(kGreatestLag * grid.across, kShortLag))) {
    if (lag < kLeastLag) continue;
    const Differences second = differences(grid, 2 * lag, [&](int u, int v) {
      return double{grid.at(u + 2 * lag, v)} - 2.0 * double{grid.at(u + lag, v)} +
             double{grid.at(u, v)};
    });
    const double variance = second.meanSquare - second.mean * second.mean;
    if (second.count < leastPairs || !(variance > kLeastVariance * second.meanSquare)) continue;
    logarithms.emplace_back(std::log(lag), 0.5 * std::log(variance));
  }
  return slopeOf(logarithms);
}

}  // namespace

Correlation correlationAlong(const HeightGrid& grid) {
  Correlation result;
  const auto leastPairs = static_cast<std::size_t>(
      std::ceil(kLeastPairs * static_cast<double>(grid.across) * static_cast<double>(grid.down)));
  for (const int lag : lagsTo(kLongestLag * grid.across)) {
    const Differences first = differences(grid, lag, [&](int u, int v) {
      return double{grid.at(u + lag, v)} - double{grid.at(u, v)};
    });
    if (first.count < leastPairs || !(first.meanSquare > 0.0)) continue;
    result.lags.push_back(lag * grid.spacing);
    result.values.push_back(std::sqrt(first.meanSquare));
  }
  result.slope = slopeAlong(grid, leastPairs);
  return result;
}

}  // namespace sherd
