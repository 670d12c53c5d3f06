// Impacts: their centers, and the seeds scattered around them.
#include "seed/impacts.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/random.h"
#include "seed/irwin_hall.h"
#include "seed/ray.h"

namespace sherd {
namespace {

Error usageError(std::size_t number, const std::string& what, OptionNames options = {}) {
  return Error(ErrorCode::usage, "impact " + std::to_string(number + 1) + what, std::move(options));
}

bool isFinite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

openvdb::Coord centerOnRay(const Ray& ray, std::size_t number, const Solid& solid,
                           const VoxelIndex& inside, const VoxelIndex& surface) {
  const glm::dvec3 origin = solid.frame.indexFromWorld(ray.origin);
  if (!isFinite(origin)) throw usageError(number, ": its ray's origin must be finite");
  if (!isFinite(ray.direction) || ray.direction == glm::dvec3(0.0)) {
    throw usageError(number, ": its ray's direction must be finite and not 0");
  }
  const std::optional<openvdb::Coord> hit =
      firstVoxelOnRay(inside, solid.box, origin, ray.direction);
  if (!hit) throw usageError(number, ": its ray misses the solid");
  if (surface.find(*hit)) return *hit;
  return surface.nearest({hit->x(), hit->y(), hit->z()});  // the ray starts inside
}

openvdb::Coord centerOf(const Impact& impact, std::size_t number, const Solid& solid,
                        std::uint64_t seed, const VoxelIndex& inside, const VoxelIndex& surface) {
  if (const auto* ray = std::get_if<Ray>(&impact.target)) {
    return centerOnRay(*ray, number, solid, inside, surface);
  }
  if (const auto* point = std::get_if<glm::dvec3>(&impact.target)) {
    const glm::dvec3 at = solid.frame.indexFromWorld(*point);
    if (!isFinite(at)) throw usageError(number, ": its point must be finite");
    return surface.nearest(at);
  }
  return surface.voxelAt(
      surface.at(randomBelow(surface.total(), seed, Stage::impactPosition, number)));
}

void checkRanges(const Impact& impact, std::size_t number) {
  if (impact.count < 0) throw usageError(number, ": its count must be 0 or more");
  if (!std::isfinite(impact.sigma) || impact.sigma < 0.0) {
    throw usageError(number, ": its spread must be 0 or more");
  }
  if (impact.bias < 1 || impact.bias > kMaxBias) {
    throw usageError(number, ": its bias is " + std::to_string(impact.bias) + "; expected 1 to " +
                                 std::to_string(kMaxBias));
  }
}

// Draws one voxel around the impact's center; nullopt if it is not a candidate in its component.
std::optional<VoxelKey> drawNear(const AimedImpact& aimedImpact, const glm::dvec3& side,
                                 std::uint64_t seed, std::uint64_t item,
                                 const SeedCandidates& candidates) {
  const VoxelBox& box = candidates.box;
  openvdb::Coord voxel;
  for (int axis = 0; axis < 3; ++axis) {
    const double offset = side[axis] * meanOfUniforms(static_cast<std::uint64_t>(aimedImpact.terms),
                                                      seed, Stage::impactOffset,
                                                      item * 3 + static_cast<std::uint64_t>(axis));
    const double at = std::floor(aimedImpact.center[axis] + offset + 0.5);
    if (at < box.min[axis] || at > box.max[axis]) return {};
    voxel[axis] = static_cast<int>(at);
  }
  const std::optional<VoxelKey> key = candidates.voxels.find(voxel);
  if (!key || candidates.components.at(*key) != aimedImpact.component) return {};
  return key;
}

}  // namespace

std::vector<AimedImpact> aim(const Solid& solid, const VoxelComponents& components,
                             const SeedOptions& options, std::size_t pieces,
                             const VoxelIndex& inside, const VoxelIndex& surface) {
  std::vector<Impact> impacts = options.impacts;
  impacts.resize(impacts.size() + static_cast<std::size_t>(options.randomImpacts));
  const std::size_t share = std::max<std::size_t>(
      (pieces - components.count()) / 2 / std::max<std::size_t>(impacts.size(), 1), 1);
  const openvdb::Coord dims = solid.box.dims();
  std::vector<AimedImpact> aimedImpacts;
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    const Impact& impact = impacts[i];
    checkRanges(impact, i);
    AimedImpact aimedImpact;
    aimedImpact.center = centerOf(impact, i, solid, options.seed, inside, surface);
    aimedImpact.component = components.at(*inside.find(aimedImpact.center));
    aimedImpact.count = impact.count > 0 ? static_cast<std::size_t>(impact.count) : share;
    aimedImpact.merge = impact.merge;
    if (impact.sigma > 0.0) {
      // The mean of 12 uniforms has a standard deviation of 1/12.
      aimedImpact.terms = kNormalTerms;
      aimedImpact.side = glm::dvec3(kNormalTerms * (impact.sigma / solid.frame.voxelSize));
    } else {
      aimedImpact.terms = impact.bias;
      aimedImpact.side = {dims.x(), dims.y(), dims.z()};
    }
    aimedImpacts.push_back(aimedImpact);
  }
  return aimedImpacts;
}

void scatter(const AimedImpact& aimedImpact, std::size_t number, const SeedCandidates& candidates,
             std::uint64_t seed, Chosen& chosen) {
  const VoxelComponents& components = candidates.components;
  const std::uint64_t room = candidates.inComponent[aimedImpact.component] -
                             static_cast<std::uint64_t>(std::count_if(
                                 chosen.voxels.begin(), chosen.voxels.end(), [&](VoxelKey key) {
                                   return components.at(key) == aimedImpact.component;
                                 }));
  if (aimedImpact.count > room) {
    throw usageError(number,
                     " needs " + std::to_string(aimedImpact.count) +
                         " seeds in a connected component with " + std::to_string(room) +
                         " free voxels; lower its count or try a higher resolution",
                     OptionNames{"resolution"});
  }

  // kTaken hits in a row on taken voxels mean that most of the neighborhood is taken (if half of it
  // were, the chance is 1 in 65,536); kMissed misses in a row, that it holds few candidates.
  constexpr int kTaken = 16, kMissed = 4096;
  const std::uint64_t impactSeed = randomBits(seed, Stage::impactSeed, number);
  const openvdb::Coord dims = candidates.box.dims();
  const double sideOfUnit =
      std::sqrt(12.0 * aimedImpact.terms);  // of a standard deviation of one voxel
  const double widest = 2.0 * sideOfUnit * std::max({dims.x(), dims.y(), dims.z()});
  const std::size_t end = chosen.size() + aimedImpact.count;
  glm::dvec3 side = aimedImpact.side;
  int taken = 0, missed = 0;
  for (std::uint64_t item = 0; chosen.size() < end; ++item) {
    if (std::min({side.x, side.y, side.z}) > widest) break;
    const std::optional<VoxelKey> key = drawNear(aimedImpact, side, impactSeed, item, candidates);
    if (key && chosen.add(*key)) {
      taken = missed = 0;
    } else if (++(key ? taken : missed); taken == kTaken || missed == kMissed) {
      side = glm::max(side * 1.25, glm::dvec3(0.5 * sideOfUnit));
      taken = missed = 0;
    }
  }
  if (chosen.size() == end) return;

  // A distribution this wide is uniform: take any free voxel of the component.
  std::vector<VoxelKey> freeVoxels;
  candidates.voxels.forEach([&](VoxelKey key) {
    if (components.at(key) == aimedImpact.component && !chosen.taken.contains(key))
      freeVoxels.push_back(key);
  });
  for (std::size_t i = 0; chosen.size() < end; ++i) {
    std::swap(freeVoxels[i],
              freeVoxels[i + randomBelow(freeVoxels.size() - i, impactSeed, Stage::impactRest, i)]);
    chosen.add(freeVoxels[i]);
  }
}

}  // namespace sherd
