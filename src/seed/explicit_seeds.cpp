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

// The nearest free inside voxel within kFarthestVoxels of a point in index space.
std::optional<VoxelKey> freeVoxelNear(const glm::dvec3& point, const VoxelIndex& inside,
                                      const Chosen& chosen) {
  constexpr double kBeyond = 1 << 30;  // no solid reaches there, and whole numbers still do
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(point[axis]) < kBeyond)) return {};
  }
  // The voxel that holds the point, where it does not lie on a border: what a seed file has.
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

std::string refusal(const WorldPoint& position, const Solid& solid, const VoxelIndex& inside) {
  const glm::dvec3 point = solid.frame.indexFromWorld(position).v;
  const openvdb::Coord nearest = inside.nearest(point);
  const double away =
      std::sqrt(std::pow(nearest.x() - point.x, 2) + std::pow(nearest.y() - point.y, 2) +
                std::pow(nearest.z() - point.z, 2));
  if (away <= kFarthestVoxels) return "finds each voxel within 2 of it taken by earlier seeds";
  char text[64];
  std::snprintf(text, sizeof text, "%.3g", away);
  return std::string("lies ") + text +
         " voxels from the solid, at most 2 can be; is it another mesh's?";
}

// Ids must be 1..n without gaps; return n.
int checkedFragments(std::span<const SeedPoint> points) {
  std::vector<bool> present(kMaxFragments + 1);
  int highest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int fragment = points[i].fragment;
    if (fragment < 1 || fragment > kMaxFragments) {
      throw inputError(i, "belongs to fragment " + std::to_string(fragment) +
                              ", ids go from 1 to " + std::to_string(kMaxFragments));
    }
    present[static_cast<std::size_t>(fragment)] = true;
    highest = std::max(highest, fragment);
  }
  for (int id = 1; id <= highest; ++id) {
    if (present[static_cast<std::size_t>(id)]) continue;
    throw Error(ErrorCode::input, "fragment " + std::to_string(id) +
                                      " has no seed, though ids go up to " +
                                      std::to_string(highest) + "; ids may not have gaps");
  }
  return highest;
}

}  // namespace

std::vector<Seed> seedsFromPoints(std::span<const SeedPoint> points, const Solid& solid,
                                  const Parts& parts, std::uint64_t seed) {
  const auto given = static_cast<std::size_t>(checkedFragments(points));
  const VoxelIndex inside(solid.blocks, solid.blocks.inside);
  Chosen chosen;
  std::vector<bool> seeded(parts.count());
  constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<std::size_t> firstOf(given, kNone);  // [id - 1] entry
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto key =
        freeVoxelNear(solid.frame.indexFromWorld(points[i].position).v, inside, chosen);
    if (!key) throw inputError(i, refusal(points[i].position, solid, inside));
    chosen.add(*key);
    const std::uint32_t part = parts.at(*key);
    seeded[part] = true;
    std::size_t& first = firstOf[static_cast<std::size_t>(points[i].fragment - 1)];
    if (first == kNone) first = i;
    if (parts.at(chosen.voxels[first]) != part) {
      throw inputError(i, "of fragment " + std::to_string(points[i].fragment) +
                              " lies in another part of the solid than seed " +
                              std::to_string(first + 1) + "; a fragment lies in one part");
    }
  }

  std::vector<Seed> seeds;
  const auto add = [&](VoxelKey key, std::size_t id) {
    seeds.push_back({inside.place(key), static_cast<std::uint16_t>(id)});
  };
  for (std::size_t id = 1; id <= given; ++id) add(chosen.voxels[firstOf[id - 1]], id);
  const auto missing = static_cast<std::size_t>(std::count(seeded.begin(), seeded.end(), false));
  if (given + missing > kMaxFragments) {
    throw Error(ErrorCode::usage, "the seeds and the parts without one would give " +
                                      std::to_string(given + missing) + " fragments, at most " +
                                      std::to_string(kMaxFragments) + " have an id");
  }
  if (missing > 0) {
    const std::vector<VoxelKey> drawn = onePerPart(inside, parts, inside.countInParts(parts), seed);
    for (std::size_t part = 0; part < parts.count(); ++part) {
      if (!seeded[part]) add(drawn[part], seeds.size() + 1);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto id = static_cast<std::size_t>(points[i].fragment);
    if (firstOf[id - 1] != i) add(chosen.voxels[i], id);
  }
  return seeds;
}

}  // namespace sherd
