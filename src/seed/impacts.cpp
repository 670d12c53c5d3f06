// Impacts: where they strike, and the seeds that scatter about them.
#include "seed/impacts.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "base/random.h"
#include "seed/irwin_hall.h"
#include "seed/ray.h"

namespace sherd {
namespace {

Error usageError(std::size_t number, const std::string& what) {
  return Error(ErrorCode::usage, "impact " + std::to_string(number + 1) + what);
}

bool isFinite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

openvdb::Coord struckBy(const Ray& ray, std::size_t number, const Solid& solid,
                        const VoxelIndex& inside, const VoxelIndex& surface) {
  const glm::dvec3 origin = solid.frame.indexFromWorld(ray.origin).v;
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

openvdb::Coord struck(const Impact& impact, std::size_t number, const Solid& solid,
                      std::uint64_t seed, const VoxelIndex& inside, const VoxelIndex& surface) {
  if (const auto* ray = std::get_if<Ray>(&impact.place)) {
    return struckBy(*ray, number, solid, inside, surface);
  }
  if (const auto* point = std::get_if<WorldPoint>(&impact.place)) {
    const glm::dvec3 at = solid.frame.indexFromWorld(*point).v;
    if (!isFinite(at)) throw usageError(number, ": its point must be finite");
    return surface.nearest(at);
  }
  return surface.place(surface.at(randomBelow(surface.total(), seed, Stage::impactPlace, number)));
}

void checkRanges(const Impact& impact, std::size_t number) {
  if (impact.count < 0) throw usageError(number, ": its count must be 0 or more");
  if (!std::isfinite(impact.spread) || impact.spread < 0.0) {
    throw usageError(number, ": its spread must be 0 or more");
  }
  if (impact.bias < 1 || impact.bias > kMaxBias) {
    throw usageError(number, ": its bias is " + std::to_string(impact.bias) + ", 1 to " +
                                 std::to_string(kMaxBias) + " can be");
  }
}

// One draw about the blow's centre.
std::optional<VoxelKey> drawNear(const Blow& blow, const glm::dvec3& side, std::uint64_t seed,
                                 std::uint64_t item, const VoxelIndex& candidates,
                                 const VoxelBox& box, const Parts& parts) {
  openvdb::Coord voxel;
  for (int axis = 0; axis < 3; ++axis) {
    const double offset = side[axis] * meanOfUniforms(static_cast<std::uint64_t>(blow.terms), seed,
                                                      Stage::impactOffset,
                                                      item * 3 + static_cast<std::uint64_t>(axis));
    const double at = std::floor(blow.centre[axis] + offset + 0.5);
    if (at < box.min[axis] || at > box.max[axis]) return {};
    voxel[axis] = static_cast<int>(at);
  }
  const std::optional<VoxelKey> key = candidates.find(voxel);
  if (!key || parts.at(*key) != blow.part) return {};
  return key;
}

}  // namespace

std::vector<Blow> aim(const Solid& solid, const Parts& parts, const SeedOptions& options,
                      std::size_t pieces, const VoxelIndex& inside, const VoxelIndex& surface) {
  std::vector<Impact> impacts = options.impacts;
  impacts.resize(impacts.size() + static_cast<std::size_t>(options.randomImpacts));
  const std::size_t share = std::max<std::size_t>(
      (pieces - parts.count()) / 2 / std::max<std::size_t>(impacts.size(), 1), 1);
  const openvdb::Coord dims = solid.box.dims();
  std::vector<Blow> blows;
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    const Impact& impact = impacts[i];
    checkRanges(impact, i);
    Blow blow;
    blow.centre = struck(impact, i, solid, options.seed, inside, surface);
    blow.part = parts.at(*inside.find(blow.centre));
    blow.count = impact.count > 0 ? static_cast<std::size_t>(impact.count) : share;
    blow.merge = impact.merge;
    if (impact.spread > 0.0) {
      // The mean of 12 uniforms has a standard deviation of 1/12.
      blow.terms = kNormalTerms;
      blow.side = glm::dvec3(kNormalTerms * (impact.spread / solid.frame.voxelSize));
    } else {
      blow.terms = impact.bias;
      blow.side = {dims.x(), dims.y(), dims.z()};
    }
    blows.push_back(blow);
  }
  return blows;
}

void scatter(const Blow& blow, std::size_t number, const VoxelIndex& candidates,
             const VoxelBox& box, const Parts& parts, std::span<const std::uint64_t> inPart,
             std::uint64_t seed, Chosen& chosen) {
  const std::uint64_t room =
      inPart[blow.part] - static_cast<std::uint64_t>(std::count_if(
                              chosen.voxels.begin(), chosen.voxels.end(),
                              [&](VoxelKey key) { return parts.at(key) == blow.part; }));
  if (blow.count > room) {
    throw usageError(number, " asks for " + std::to_string(blow.count) +
                                 " seeds in a part of the solid with room for " +
                                 std::to_string(room) +
                                 "; lower its count or try a higher --resolution");
  }

  // So many hits in a row on taken voxels mean that most of the neighbourhood is taken (were it
  // half, once in 65,536 times); so many misses in a row, that hardly any of the part is there.
  constexpr int kTaken = 16, kMissed = 4096;
  const std::uint64_t own = randomBits(seed, Stage::impactSeed, number);
  const openvdb::Coord dims = box.dims();
  const double sideOfUnit = std::sqrt(12.0 * blow.terms);  // of a standard deviation of one voxel
  const double widest = 2.0 * sideOfUnit * std::max({dims.x(), dims.y(), dims.z()});
  const std::size_t end = chosen.size() + blow.count;
  glm::dvec3 side = blow.side;
  int taken = 0, missed = 0;
  for (std::uint64_t item = 0; chosen.size() < end; ++item) {
    if (std::min({side.x, side.y, side.z}) > widest) break;
    const std::optional<VoxelKey> key = drawNear(blow, side, own, item, candidates, box, parts);
    if (key && chosen.add(*key)) {
      taken = missed = 0;
    } else if (++(key ? taken : missed); taken == kTaken || missed == kMissed) {
      side = glm::max(side * 1.25, glm::dvec3(0.5 * sideOfUnit));
      taken = missed = 0;
    }
  }
  if (chosen.size() == end) return;

  // As wide as that, it is any free voxel of the part.
  std::vector<VoxelKey> open;
  candidates.forEach([&](VoxelKey key) {
    if (parts.at(key) == blow.part && !chosen.taken.contains(key)) open.push_back(key);
  });
  for (std::size_t i = 0; chosen.size() < end; ++i) {
    std::swap(open[i], open[i + randomBelow(open.size() - i, own, Stage::impactRest, i)]);
    chosen.add(open[i]);
  }
}

}  // namespace sherd
