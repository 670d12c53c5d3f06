#include "grow_reference.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <queue>

namespace sherd::reference {

std::uint64_t distance(Metric metric, const Coord& a, const Coord& b) {
  const std::int64_t x = std::abs(a.x() - b.x()), y = std::abs(a.y() - b.y()),
                     z = std::abs(a.z() - b.z());
  switch (metric) {
    case Metric::euclidean:
      return static_cast<std::uint64_t>(x * x + y * y + z * z);
    case Metric::chebyshev:
      return static_cast<std::uint64_t>(std::max({x, y, z}));
    case Metric::manhattan:
      break;
  }
  return static_cast<std::uint64_t>(x + y + z);
}

namespace {

struct Nearest {
  std::int64_t cost = std::numeric_limits<std::int64_t>::max();
  std::uint16_t label = 0;
};

// The nearest seed to a point, a voxel's center, in steps of seeds; ties to the lower label.
// Weights are subtracted from squared distances.
Nearest nearestTo(const glm::i64vec3& point, const std::vector<Seed>& seeds, Metric metric) {
  Nearest best;
  for (const Seed& seed : seeds) {
    const glm::i64vec3 apart = stepsOf(seed) - point;
    const std::int64_t d = metricOrder(metric, apart.x, apart.y, apart.z) -
                           (metric == Metric::euclidean ? seed.weight : 0);
    if (d < best.cost || (d == best.cost && seed.fragment < best.label)) best = {d, seed.fragment};
  }
  return best;
}

Nearest nearestTo(const Coord& voxel, const std::vector<Seed>& seeds, Metric metric) {
  return nearestTo(stepsOf(Seed{voxel}), seeds, metric);
}

}  // namespace

std::vector<Seed> settled(std::vector<Seed> seeds, Metric metric) {
  for (int pass = 0;; ++pass) {
    const std::vector<Seed> before = seeds;
    for (Seed& seed : seeds) {
      if (nearestTo(seed.voxel, before, metric).label != seed.fragment) seed.shift = glm::ivec3(0);
    }
    if (seeds == before) return seeds;
    if (pass == 7) break;
  }
  for (Seed& seed : seeds) seed.shift = glm::ivec3(0);
  return seeds;
}

std::map<Coord, Arrival> nearest(const voxel_shapes::VoxelSolid& solid,
                                 const std::vector<Seed>& seeds, Metric metric) {
  const std::vector<Seed> points = settled(seeds, metric);
  const int bits = metric == Metric::euclidean ? 12 : 6;  // of a voxel's 64 steps, squared or not
  std::map<Coord, Arrival> owned;
  for (const Coord& voxel : solid.inside) {
    const Nearest own = nearestTo(voxel, points, metric);
    owned[voxel] = {static_cast<std::uint64_t>(std::max<std::int64_t>(own.cost, 0)) >> bits,
                    own.label};
  }
  return owned;
}

std::map<Coord, Arrival> nearestInWalls(const voxel_shapes::VoxelSolid& solid,
                                        const std::vector<Seed>& settledSeeds,
                                        const std::function<glm::ivec3(const Coord&)>& wayOf) {
  std::map<Coord, Arrival> owned;
  for (const Coord& voxel : solid.inside) {
    const glm::i64vec3 point = stepsOf(Seed{voxel}) + glm::i64vec3(wayOf(voxel));
    const Nearest own = nearestTo(point, settledSeeds, Metric::euclidean);
    owned[voxel] = {static_cast<std::uint64_t>(std::max<std::int64_t>(own.cost, 0)) >> 12,
                    own.label};
  }
  return owned;
}

std::vector<Step> moore() {
  std::vector<Step> steps;
  for (int i = 0; i < 27; ++i) {
    if (i != 13) steps.push_back({{i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1}, 1, {}});
  }
  return steps;
}

std::vector<Step> chamfer() {
  std::vector<Step> steps;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if (std::gcd(std::gcd(x, y), z) != 1) continue;
        Step step{{x, y, z},
                  static_cast<std::uint64_t>(std::lround(16.0 * std::sqrt(x * x + y * y + z * z))),
                  {}};
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == 2) {
          const auto up = [](int v) { return v / 2 + v % 2; };
          step.over = {{x / 2, y / 2, z / 2}, {up(x), up(y), up(z)}};
        }
        steps.push_back(step);
      }
    }
  }
  return steps;
}

std::map<Coord, Arrival> dijkstra(const std::set<Coord>& inside, const LabelMap& start,
                                  const std::vector<Step>& steps) {
  using Entry = std::tuple<std::uint64_t, std::uint16_t, Coord>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const auto& [voxel, label] : start) queue.push({0, label, voxel});
  std::map<Coord, Arrival> owned;
  while (!queue.empty()) {
    const auto [cost, label, voxel] = queue.top();
    queue.pop();
    if (!owned.try_emplace(voxel, Arrival{cost, label}).second) continue;
    for (const Step& step : steps) {
      const Coord next = voxel + step.to;
      bool open = inside.count(next) && !owned.count(next) && !start.count(next);
      for (const Coord& over : step.over) open = open && inside.count(voxel + over);
      if (open) queue.push({cost + step.weight, label, next});
    }
  }
  return owned;
}

namespace {

// Adds the 6-connected component of `from` with its label to `component`.
void collect(const LabelMap& labels, const Coord& from, LabelMap& component) {
  const std::uint16_t label = labels.at(from);
  std::vector<Coord> stack{from};
  component[from] = label;
  while (!stack.empty()) {
    const Coord voxel = stack.back();
    stack.pop_back();
    for (const Coord& n : voxel_shapes::neighbors(voxel)) {
      const auto at = labels.find(n);
      if (at == labels.end() || at->second != label) continue;
      if (component.try_emplace(n, label).second) stack.push_back(n);
    }
  }
}

}  // namespace

LabelMap kept(const LabelMap& labels, const std::vector<Seed>& seeds) {
  LabelMap component;
  std::set<std::uint16_t> seen;
  for (const Seed& seed : seeds) {
    if (seen.insert(seed.fragment).second) collect(labels, seed.voxel, component);
  }
  return component;
}

std::size_t countConnectedComponents(const LabelMap& labels) {
  LabelMap done;
  std::size_t components = 0;
  for (const auto& [voxel, label] : labels) {
    if (done.count(voxel)) continue;
    collect(labels, voxel, done);
    ++components;
  }
  return components;
}

LabelMap mapOf(const Labels& labels) {
  const LeafBlocks& blocks = *labels.blocks;
  LabelMap map;
  for (std::size_t word = 0; word < blocks.inside.size(); ++word) {
    for (std::uint64_t bits = blocks.inside[word]; bits; bits &= bits - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
      const std::uint16_t label = labels.fragment[word * 64 + bit];
      const auto offset = static_cast<std::uint32_t>(word % 8 * 64) + bit;
      if (label) map[blocks.origins[word / 8] + coordFromOffset(offset)] = label;
    }
  }
  return map;
}

}  // namespace sherd::reference
