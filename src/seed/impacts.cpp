// Impacts: their centers, and the seeds scattered around them.
#include "seed/impacts.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <string>
#include <utility>

#include "base/cancel_flag.h"
#include "base/finite.h"
#include "base/random.h"
#include "base/text/formatted.h"
#include "seed/draw/irwin_hall.h"
#include "seed/impact_rings.h"
#include "seed/ray.h"
#include "voxelize/canonical_solid.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

Error usageError(std::size_t number, const std::string& what, OptionNames options = {}) {
  return Error(ErrorCode::usage, "impact " + std::to_string(number + 1) + what, std::move(options));
}

// Returns whether a point of the mesh belongs to the solid, not to a component that was dropped.
bool isAtSolid(const glm::dvec3& point, const VoxelIndex& surface) {
  constexpr double kNear = 3.0;  // voxels
  return surface.nearestWithin(point, kNear).has_value();
}

IndexPoint pointOnRay(const Ray& ray, std::size_t number, const Solid& solid,
                      const VoxelIndex& inside, const VoxelIndex& surface) {
  const IndexPoint origin = solid.frame.indexFromWorld(ray.origin);
  if (!isFinite(origin)) throw usageError(number, ": its ray's origin must be finite");
  if (!isFinite(ray.direction) || ray.direction == glm::dvec3(0.0)) {
    throw usageError(number, ": its ray's direction must be finite and not 0");
  }
  const std::optional<openvdb::Coord> hit =
      firstVoxelOnRay(inside, solid.box, origin, ray.direction);
  if (!hit) throw usageError(number, ": its ray misses the solid");
  if (solid.region) {
    const auto met = solid.region->firstHit(origin, ray.direction);
    if (met && isAtSolid(*met, surface)) return *met;
  }
  return centerOf(surface.find(*hit) ? *hit : surface.nearest(centerOf(*hit)));
}

IndexPoint pointNearest(const WorldPoint& target, std::size_t number, const Solid& solid,
                        const VoxelIndex& surface) {
  const IndexPoint at = solid.frame.indexFromWorld(target);
  if (!isFinite(at)) throw usageError(number, ": its point must be finite");
  if (solid.region) {
    const IndexPoint on = solid.region->onSurface(at);
    if (isAtSolid(on, surface)) return on;
  }
  return centerOf(surface.nearest(at));
}

// Returns a random point of the surface.
IndexPoint anywhere(const Candidates& onSurface, std::uint64_t seed, std::size_t number) {
  const VoxelIndex& voxels = onSurface.voxels();
  for (std::uint64_t i = 0; i < onSurface.drawsForOne(); ++i) {
    const auto found =
        onSurface.inBox(randomPoint(seed, Stage::impactPosition, drawItem(number, i)));
    if (found && found->key) return pointOf({voxels.voxelAt(*found->key), 0, found->shift});
  }
  return centerOf(
      voxels.voxelAt(voxels.at(randomBelow(voxels.total(), seed, Stage::impactVoxel, number))));
}

IndexPoint aimedPoint(const Impact& impact, std::size_t number, const Solid& solid,
                      std::uint64_t seed, const VoxelIndex& inside, const Candidates& onSurface) {
  if (const auto* ray = std::get_if<Ray>(&impact.target)) {
    return pointOnRay(*ray, number, solid, inside, onSurface.voxels());
  }
  if (const auto* point = std::get_if<WorldPoint>(&impact.target)) {
    return pointNearest(*point, number, solid, onSurface.voxels());
  }
  return anywhere(onSurface, seed, number);
}

void checkRanges(const Impact& impact, std::size_t number) {
  if (impact.count < 0) throw usageError(number, ": its count must be 0 or more");
  if (!std::isfinite(impact.sigma) || impact.sigma < 0.0) {
    throw usageError(number, ": its spread must be 0 or more");
  }
  if (impact.energy != 0.0 && !(impact.energy >= kLeastEnergy && impact.energy <= kMostEnergy)) {
    throw usageError(number, ": its energy must be 0, or lie in 0.01..100");
  }
  if (impact.bias < 1 || impact.bias > kMaxBias) {
    throw usageError(number, ": its bias is " + std::to_string(impact.bias) + "; expected 1 to " +
                                 std::to_string(kMaxBias));
  }
}

// Returns the points of rings.  Where the wall ends or bends is decided on the canonical solid, so
// that there are as many at every resolution.
//   side  longest of the mesh's box, voxels
std::vector<glm::dvec3> pointsOfRings(const Impact& impact, const glm::dvec3& center,
                                      std::uint64_t impactSeed, const Solid& solid, double side,
                                      const Progress* progress) {
  const std::shared_ptr<const Solid> canonical = canonicalOf(solid, progress);
  const Solid& on = canonical ? *canonical : solid;
  const VoxelScale to = VoxelScale::between(solid, on), from = VoxelScale::between(on, solid);
  const RingPattern pattern =
      ringPatternFor(impact.energy, side * to.ratio, impact.sigma / on.frame.voxelSize);
  std::vector<glm::dvec3> points =
      ringPoints(pattern, Walls(on), canonical ? to.position(center) : center, impactSeed);
  if (!canonical) return points;
  for (glm::dvec3& point : points) point = from.position(point);
  return points;
}

// Sets the rings of an impact with an energy, and how the seeds that they do not give scatter.
//   available  seeds where the impact has no count
void setRings(AimedImpact& aimedImpact, const Impact& impact, std::uint64_t impactSeed,
              const Solid& solid, double side, std::size_t available, const Progress* progress) {
  const RingPattern pattern =
      ringPatternFor(impact.energy, side, impact.sigma / solid.frame.voxelSize);
  const std::vector<glm::dvec3> points =
      pointsOfRings(impact, aimedImpact.center, impactSeed, solid, side, progress);
  if (impact.count == 0) {
    aimedImpact.count = std::min(points.empty() ? pattern.seeds() : points.size(), available);
  }
  aimedImpact.pattern = pattern;
  aimedImpact.rings = innerPoints(points, pattern, aimedImpact.count);
  aimedImpact.terms = kNormalTerms;
  aimedImpact.side = glm::dvec3(kNormalTerms * 0.5 * pattern.radius);
}

// Draws one candidate around the impact's center.
std::optional<Candidate> drawNear(const AimedImpact& aimedImpact, const glm::dvec3& side,
                                  std::uint64_t seed, std::uint64_t item,
                                  const Candidates& candidates) {
  glm::dvec3 point = aimedImpact.center;
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] += side[axis] * meanOfUniforms(static_cast<std::uint64_t>(aimedImpact.terms), seed,
                                               Stage::impactOffset,
                                               item * 3 + static_cast<std::uint64_t>(axis));
  }
  return candidates.at(point);
}

// Adds the seeds on rings.  One whose voxel is taken, or whose wall the voxels do not resolve,
// takes the nearest voxel that is free, so that those after it keep their numbers; where none is
// near, it is left out.
void addRings(const AimedImpact& aimedImpact, const Candidates& candidates, std::size_t end,
              Chosen& chosen) {
  for (const glm::dvec3& point : aimedImpact.rings) {
    if (chosen.size() == end) return;
    std::optional<Candidate> found = candidates.at(point);
    if (!found) continue;
    const auto isFree = [&](VoxelKey key) {
      return chosen.components().at(key) == aimedImpact.component && !chosen.has(key);
    };
    if (!found->key || !isFree(*found->key)) {
      constexpr double kNear = 8.0;  // voxels
      found->key = candidates.voxels().nearestWithin(point, kNear, isFree);
      if (found->key) found->shift = shiftOf(point, candidates.voxels().voxelAt(*found->key));
    }
    (void)chosen.add(*found);
  }
}

}  // namespace

std::vector<AimedImpact> aim(const Solid& solid, const VoxelComponents& components,
                             const SeedOptions& options, std::size_t pieces,
                             const VoxelIndex& inside, const VoxelIndex& surface,
                             const Progress* progress) {
  std::vector<Impact> impacts = options.impacts;
  impacts.resize(impacts.size() + static_cast<std::size_t>(options.randomImpacts));
  const std::size_t share = std::max<std::size_t>(
      (pieces - components.count()) / 2 / std::max<std::size_t>(impacts.size(), 1), 1);
  const Candidates onSurface(solid, surface, SeedsOn::surface);
  std::vector<AimedImpact> aimedImpacts;
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    const Impact& impact = impacts[i];
    checkRanges(impact, i);
    AimedImpact aimedImpact;
    aimedImpact.center = aimedPoint(impact, i, solid, options.seed, inside, onSurface);
    aimedImpact.component = components.at(*inside.find(surface.nearest(aimedImpact.center)));
    aimedImpact.count = impact.count > 0 ? static_cast<std::size_t>(impact.count) : share;
    aimedImpact.merge = impact.merge;
    if (impact.energy > 0.0) {
      const std::size_t all = (pieces - components.count()) / impacts.size();
      const glm::dvec3& sides = onSurface.sides();
      setRings(aimedImpact, impact, randomBits(options.seed, Stage::impactSeed, i), solid,
               std::max({sides.x, sides.y, sides.z}), std::max<std::size_t>(all, 1), progress);
    } else if (impact.sigma > 0.0) {
      // The mean of 12 uniforms has a standard deviation of 1/12.
      aimedImpact.terms = kNormalTerms;
      aimedImpact.side = glm::dvec3(kNormalTerms * (impact.sigma / solid.frame.voxelSize));
    } else {
      aimedImpact.terms = impact.bias;
      aimedImpact.side = onSurface.sides();
    }
    aimedImpacts.push_back(aimedImpact);
  }
  return aimedImpacts;
}

std::optional<IndexPoint> firstImpact(const Solid& solid, const SeedOptions& options) {
  if (options.impacts.empty()) return {};
  const std::vector<std::uint64_t> surface = surfaceMask(*solid.blocks);
  const VoxelIndex inside(*solid.blocks, solid.blocks->inside), onSurface(*solid.blocks, surface);
  return aimedPoint(options.impacts.front(), 0, solid, options.seed, inside,
                    Candidates(solid, onSurface, SeedsOn::surface));
}

void requireNearImpacts(const Solid& solid, std::span<const Impact> impacts) {
  std::optional<VoxelIndex> surface;
  const std::vector<std::uint64_t> mask = surfaceMask(*solid.blocks);
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    const auto* const target = std::get_if<WorldPoint>(&impacts[i].target);
    if (target == nullptr) continue;
    if (!surface) surface.emplace(*solid.blocks, mask);
    const glm::dvec3 center = pointNearest(*target, i, solid, *surface);
    const double apart = glm::distance(solid.frame.indexFromWorld(*target), center);
    if (apart <= kMostImpactDistance * solid.box.longestSide()) continue;
    throw usageError(i, ": its point is " + formatted("%.4g", apart * solid.frame.voxelSize) +
                            " from the surface, more than 5 % of the longest side; give a point "
                            "of the surface, or a ray that meets it");
  }
}

void scatter(const AimedImpact& aimedImpact, std::size_t number, const Candidates& candidates,
             std::uint64_t inComponent, std::uint64_t seed, Chosen& chosen,
             const Progress* progress) {
  const VoxelComponents& components = chosen.components();
  const std::uint64_t room =
      inComponent - static_cast<std::uint64_t>(std::count_if(
                        chosen.all().begin(), chosen.all().end(), [&](const Candidate& each) {
                          return components.at(*each.key) == aimedImpact.component;
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
  const glm::dvec3& sides = candidates.sides();
  const double sideOfUnit =
      std::sqrt(12.0 * aimedImpact.terms);  // of a standard deviation of one voxel
  // A distribution wider than the box is uniform.
  const double widest = 2.0 * sideOfUnit * std::max({sides.x, sides.y, sides.z});
  const std::size_t end = chosen.size() + aimedImpact.count;
  addRings(aimedImpact, candidates, end, chosen);
  glm::dvec3 side = aimedImpact.side;
  int taken = 0, missed = 0;
  for (std::uint64_t own = 0, draw = 0; chosen.size() < end; ++draw) {
    throwIfCancelled(progress);
    const std::uint64_t item = drawItem(own, draw);
    const bool isUniform = std::min({side.x, side.y, side.z}) > widest;
    auto found = isUniform ? candidates.inBox(randomPoint(impactSeed, Stage::impactPoint, item))
                           : drawNear(aimedImpact, side, impactSeed, item, candidates);
    if (found && !(found->key && components.at(*found->key) == aimedImpact.component))
      found.reset();
    if (found && chosen.add(*found)) {
      taken = missed = 0;
      ++own, draw = 0;
    } else if (++(found ? taken : missed); taken == kTaken || missed == kMissed) {
      if (isUniform) break;
      side = glm::max(side * 1.25, glm::dvec3(0.5 * sideOfUnit));
      taken = missed = 0;
    }
  }
  if (chosen.size() == end) return;

  // Hardly anything is free: take any free voxel of the component.
  std::vector<VoxelKey> freeVoxels;
  candidates.voxels().forEach([&](VoxelKey key) {
    if (components.at(key) == aimedImpact.component && !chosen.has(key)) freeVoxels.push_back(key);
  });
  for (std::size_t i = 0; chosen.size() < end; ++i) {
    std::swap(freeVoxels[i],
              freeVoxels[i + randomBelow(freeVoxels.size() - i, impactSeed, Stage::impactRest, i)]);
    chosen.add(candidates.ofVoxel(freeVoxels[i]));
  }
}

}  // namespace sherd
