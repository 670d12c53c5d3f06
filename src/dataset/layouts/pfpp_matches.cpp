// Matches points of touching fragments.
#include "dataset/layouts/pfpp_matches.h"

#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace sherd {
namespace {

constexpr std::size_t kLeastMatches = 3;

/// A point of a part on its crack with another one.
struct CrackPoint {
  glm::vec3 position;
  std::int64_t critical;  ///< its place among the part's points on cracks
};

// [points] the index of the nearest of `others`, ties to the first.
std::vector<std::size_t> nearest(std::span<const CrackPoint> points,
                                 std::span<const CrackPoint> others) {
  std::vector<std::size_t> found;
  for (const CrackPoint& point : points) {
    std::size_t best = 0;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < others.size(); ++k) {
      const glm::vec3 apart = point.position - others[k].position;
      const float squared = glm::dot(apart, apart);
      if (squared >= least) continue;
      least = squared;
      best = k;
    }
    found.push_back(best);
  }
  return found;
}

NpyTable matched(std::span<const CrackPoint> a, std::span<const CrackPoint> b) {
  NpyTable table{2, {}};
  if (a.empty() || b.empty()) return table;
  const std::vector<std::size_t> ofA = nearest(a, b), ofB = nearest(b, a);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (ofB[ofA[i]] != i) continue;
    table.numbers.push_back(a[i].critical);
    table.numbers.push_back(b[ofA[i]].critical);
  }
  return table;
}

}  // namespace

PfppMatching pfppMatching(std::span<const glm::vec3> positions,
                          std::span<const std::uint16_t> neighbor,
                          std::span<const std::size_t> counts) {
  const std::size_t parts = counts.size();
  PfppMatching matching;
  matching.critical.assign(positions.size(), 0);
  matching.criticalCounts.assign(parts, 0);
  std::vector<std::vector<CrackPoint>> between(parts * parts);  // of part i that face part j
  for (std::size_t i = 0, first = 0; i < parts; first += counts[i++]) {
    std::size_t& count = matching.criticalCounts[i];
    for (std::size_t k = 0; k < counts[i]; ++k) {
      const std::size_t faces = neighbor[first + k];
      if (faces == 0) continue;
      if (faces <= parts) {
        between[i * parts + faces - 1].push_back(
            {positions[first + k], static_cast<std::int64_t>(count)});
      }
      matching.critical[first + count++] = k;
    }
  }
  for (std::size_t i = 0; i < parts; ++i) {
    for (std::size_t j = i + 1; j < parts; ++j) {
      NpyTable table = matched(between[i * parts + j], between[j * parts + i]);
      if (table.numbers.size() < 2 * kLeastMatches) continue;
      matching.edges.push_back(j);
      matching.edges.push_back(i);
      matching.tables.push_back(std::move(table));
    }
  }
  return matching;
}

}  // namespace sherd
