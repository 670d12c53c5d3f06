// Seeds of an impact on a thin wall: rings about its point, cut by radial cracks.
#include "seed/impact_rings.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/random.h"

namespace sherd {
namespace {

// A number in -1..1.
double jitter(std::uint64_t seed, std::uint64_t item) {
  return 2.0 * randomUnit(seed, Stage::impactRing, item) - 1.0;
}

}  // namespace

double RingPattern::rowRadius(int row) const {
  const double first = radius / std::pow(ratio, rings - 1);  // of the ring cracks
  return 2.0 * first / (1.0 + ratio) * std::pow(ratio, row);
}

RingPattern ringPatternFor(double energy, double side, double radius) {
  const double root = std::pow(energy, 0.25);
  RingPattern pattern;
  pattern.radials = std::max(3, static_cast<int>(std::floor(8.0 * root + 0.5)));
  pattern.rings = std::max(1, static_cast<int>(std::floor(3.0 * root + 0.5)));
  pattern.ratio = 1.0 + 2.0 * std::numbers::pi / pattern.radials;
  pattern.radius = radius > 0.0 ? radius : 0.25 * side * std::sqrt(root);
  return pattern;
}

std::vector<glm::dvec3> ringPoints(const RingPattern& pattern, const Walls& walls,
                                   const glm::dvec3& at, std::uint64_t seed) {
  const double most = 0.5 * pattern.radius;
  const std::optional<Wall> wall = walls.at(at, most);
  if (!wall) return {};
  const glm::dvec3 n = wall->normal;
  const glm::dvec3 axis = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(n, axis)), v = glm::cross(n, u);
  const auto rows = static_cast<std::size_t>(pattern.rings) + 1;
  const auto sectors = static_cast<std::size_t>(pattern.radials);
  // Jitters are those of whole rows and sectors, so that radial cracks and rings run through.
  std::vector<double> radii;
  for (std::size_t row = 0; row < rows; ++row) {
    const double spacing = 1.0 - 1.0 / pattern.ratio;
    radii.push_back(pattern.rowRadius(static_cast<int>(row)) *
                    (1.0 + 0.15 * spacing * jitter(seed, row)));
  }
  const double first = std::numbers::pi * jitter(seed, rows);
  std::vector<std::vector<IndexPoint>> ways;  // [sector] along each
  for (std::size_t sector = 0; sector < sectors; ++sector) {
    const double turn = static_cast<double>(sector) + 0.25 * jitter(seed, rows + 1 + sector);
    const double angle = first + 2.0 * std::numbers::pi * turn / static_cast<double>(sectors);
    ways.push_back(walls.walk(wall->surface, std::cos(angle) * u + std::sin(angle) * v, radii));
  }
  std::vector<glm::dvec3> points;
  for (std::size_t row = 0; row < rows; ++row) {
    for (const std::vector<IndexPoint>& way : ways) {
      if (row >= way.size()) continue;
      if (const std::optional<Wall> there = walls.at(way[row], most))
        points.push_back(there->middle);
    }
  }
  return points;
}

std::vector<glm::dvec3> innerPoints(const std::vector<glm::dvec3>& points,
                                    const RingPattern& pattern, std::size_t count) {
  if (count >= points.size()) return points;
  const auto sectors = static_cast<std::size_t>(pattern.radials);
  const std::size_t whole = count / sectors * sectors, rest = count - whole;
  std::vector<glm::dvec3> inner(points.begin(),
                                points.begin() + static_cast<std::ptrdiff_t>(whole));
  const std::size_t row = std::min(sectors, points.size() - whole);
  for (std::size_t i = 0; i < rest; ++i) inner.push_back(points[whole + i * row / rest]);
  return inner;
}

}  // namespace sherd
