// Seeds at given points.
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/common.hpp>
#include <optional>
#include <string>

#include "seed/samplers.h"
#include "seed/voxel_index.h"

namespace sherd {
namespace {

constexpr double kFarthestVoxels = 2.0;

Error inputError(std::size_t entry, const std::string& what) {
  return Error(ErrorCode::input, "seed " + std::to_string(entry + 1) + " " + what);
}

// Returns the nearest free inside voxel within kFarthestVoxels of a point in index space.
std::optional<VoxelKey> freeVoxelNear(const glm::dvec3& point, const VoxelIndex& inside,
                                      const Chosen& chosen) {
  constexpr double kBeyond = 1 << 30;  // outside every solid, and still fits an int
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(point[axis]) < kBeyond)) return {};
  }
  // Fast path for seed files: the voxel that contains the point, unless it lies on a face.
  const glm::dvec3 rounded = glm::floor(point + 0.5);
  const glm::dvec3 off = glm::abs(rounded - point);
  if (off.x < 0.5 && off.y < 0.5 && off.z < 0.5) {
    const std::optional<VoxelKey> key = inside.find(
        {static_cast<int>(rounded.x), static_cast<int>(rounded.y), static_cast<int>(rounded.z)});
    if (key && !chosen.taken.contains(*key)) return key;
  }
  const auto low = [&](int axis) {
    return static_cast<int>(std::ceil(point[axis] - kFarthestVoxels));
  };
  const auto high = [&](int axis) {
    return static_cast<int>(std::floor(point[axis] + kFarthestVoxels));
  };
  std::optional<VoxelKey> best;
  double least = kFarthestVoxels * kFarthestVoxels;
  for (int x = low(0); x <= high(0); ++x) {
    for (int y = low(1); y <= high(1); ++y) {
      for (int z = low(2); z <= high(2); ++z) {
        const glm::dvec3 d = glm::dvec3(x, y, z) - point;
        const double square = d.x * d.x + d.y * d.y + d.z * d.z;
        if (square > least || (best && square == least)) continue;
        const std::optional<VoxelKey> key = inside.find({x, y, z});
        if (!key || chosen.taken.contains(*key)) continue;
        best = key;
        least = square;
      }
    }
  }
  return best;
}

std::string refusal(const glm::dvec3& position, const Solid& solid, const VoxelIndex& inside) {
  const glm::dvec3 point = solid.frame.indexFromWorld(position);
  const openvdb::Coord nearest = inside.nearest(point);
  const double away =
      std::sqrt(std::pow(nearest.x() - point.x, 2) + std::pow(nearest.y() - point.y, 2) +
                std::pow(nearest.z() - point.z, 2));
  if (away <= kFarthestVoxels) return "has no free voxel within 2 voxels; earlier seeds took them";
  char text[64];
  std::snprintf(text, sizeof text, "%.3g", away);
  return std::string("lies ") + text +
         " voxels from the solid, at most 2 are allowed; does it belong to another mesh?";
}

// Checks that ids are 1..n without gaps, and returns n.
int checkedFragments(std::span<const SeedPoint> points) {
  std::vector<bool> present(kMaxFragments + 1);
  int highest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int fragment = points[i].fragment;
    if (fragment < 1 || fragment > kMaxFragments) {
      throw inputError(i, "belongs to fragment " + std::to_string(fragment) +
                              "; expected an id from 1 to " + std::to_string(kMaxFragments));
    }
    present[static_cast<std::size_t>(fragment)] = true;
    highest = std::max(highest, fragment);
  }
  for (int id = 1; id <= highest; ++id) {
    if (present[static_cast<std::size_t>(id)]) continue;
    throw Error(ErrorCode::input, "fragment " + std::to_string(id) +
                                      " has no seed; the ids must be 1 to " +
                                      std::to_string(highest) + " without gaps");
  }
  return highest;
}

}  // namespace

std::vector<Seed> seedsFromPoints(std::span<const SeedPoint> points, const Solid& solid,
                                  const VoxelComponents& components, std::uint64_t seed) {
  const auto given = static_cast<std::size_t>(checkedFragments(points));
  const VoxelIndex inside(*solid.blocks, solid.blocks->inside);
  Chosen chosen;
  std::vector<bool> seeded(components.count());
  constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<std::size_t> firstOf(given, kNone);  // [id - 1] entry
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto key = freeVoxelNear(solid.frame.indexFromWorld(points[i].position), inside, chosen);
    if (!key) throw inputError(i, refusal(points[i].position, solid, inside));
    chosen.add(*key);
    const std::uint32_t component = components.at(*key);
    seeded[component] = true;
    std::size_t& first = firstOf[static_cast<std::size_t>(points[i].fragment - 1)];
    if (first == kNone) first = i;
    if (components.at(chosen.voxels[first]) != component) {
      throw inputError(i, "of fragment " + std::to_string(points[i].fragment) +
                              " lies in another connected component than seed " +
                              std::to_string(first + 1) + "; a fragment must lie in one");
    }
  }

  std::vector<Seed> seeds;
  const auto add = [&](VoxelKey key, std::size_t id) {
    seeds.push_back({inside.voxelAt(key), static_cast<std::uint16_t>(id)});
  };
  for (std::size_t id = 1; id <= given; ++id) add(chosen.voxels[firstOf[id - 1]], id);
  const auto missing = static_cast<std::size_t>(std::count(seeded.begin(), seeded.end(), false));
  if (given + missing > kMaxFragments) {
    throw Error(ErrorCode::usage, "the seeds and the connected components without one give " +
                                      std::to_string(given + missing) + " fragments; at most " +
                                      std::to_string(kMaxFragments) + " are possible");
  }
  if (missing > 0) {
    const std::vector<VoxelKey> drawn =
        onePerComponent(inside, components, inside.countInComponents(components), seed);
    for (std::size_t component = 0; component < components.count(); ++component) {
      if (!seeded[component]) add(drawn[component], seeds.size() + 1);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto id = static_cast<std::size_t>(points[i].fragment);
    if (firstOf[id - 1] != i) add(chosen.voxels[i], id);
  }
  return seeds;
}

}  // namespace sherd
