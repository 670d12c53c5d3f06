// Seeds at given points.
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "seed/draw/samplers.h"
#include "seed/draw/voxel_index.h"

namespace sherd {
namespace {

constexpr double kFarthestVoxels = 2.0;

Error inputError(std::size_t entry, const std::string& what) {
  return Error(ErrorCode::input, "seed " + std::to_string(entry + 1) + " " + what);
}

std::string refusal(const WorldPoint& position, const Solid& solid, const VoxelIndex& inside) {
  const IndexPoint point = solid.frame.indexFromWorld(position);
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
  Chosen chosen(components);
  constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<std::size_t> firstOf(given, kNone);  // [id - 1] entry
  for (std::size_t i = 0; i < points.size(); ++i) {
    const IndexPoint point = solid.frame.indexFromWorld(points[i].position);
    const auto key = inside.nearestWithin(point, kFarthestVoxels,
                                          [&](VoxelKey voxel) { return !chosen.has(voxel); });
    if (!key) throw inputError(i, refusal(points[i].position, solid, inside));
    chosen.add({key, shiftOf(point, inside.voxelAt(*key))});
    const std::uint32_t component = components.at(*key);
    std::size_t& first = firstOf[static_cast<std::size_t>(points[i].fragment - 1)];
    if (first == kNone) first = i;
    if (components.at(*chosen.all()[first].key) != component) {
      throw inputError(i, "of fragment " + std::to_string(points[i].fragment) +
                              " lies in another connected component than seed " +
                              std::to_string(first + 1) + "; a fragment must lie in one");
    }
  }

  std::vector<Seed> seeds;
  const auto add = [&](const Candidate& at, std::size_t id) {
    seeds.push_back({inside.voxelAt(*at.key), static_cast<std::uint16_t>(id), at.shift});
  };
  for (std::size_t id = 1; id <= given; ++id) add(chosen.all()[firstOf[id - 1]], id);
  const std::size_t missing = chosen.unseeded();
  if (given + missing > kMaxFragments) {
    throw Error(ErrorCode::usage, "the seeds and the connected components without one give " +
                                      std::to_string(given + missing) + " fragments; at most " +
                                      std::to_string(kMaxFragments) + " are possible");
  }
  const Candidates candidates(solid, inside, SeedsOn::volume);
  const DensityTest anywhere(nullptr, solid.frame, seed);
  SeedSampler(candidates, Sampler::uniform, seed, anywhere).draw(missing, chosen);
  for (std::size_t i = points.size(); i < chosen.size(); ++i)
    add(chosen.all()[i], seeds.size() + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto id = static_cast<std::size_t>(points[i].fragment);
    if (firstOf[id - 1] != i) add(chosen.all()[i], id);
  }
  return seeds;
}

}  // namespace sherd
