// The stages of a fracture, with their options filled in.
#include "pipeline/fracture_stages.h"

#include <sherd/error.h>
#include <sherd/growth.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numeric>
#include <utility>

#include "base/random.h"
#include "erode/passes.h"
#include "grow/sized/crack_areas.h"
#include "grow/sized/raise_small.h"
#include "grow/splits/guide_sides.h"
#include "grow/splits/sequential.h"
#include "pipeline/deciding.h"
#include "pipeline/guide_surfaces.h"
#include "pipeline/withheld.h"
#include "remesh/smooth.h"
#include "seed/draw/distinct_middles.h"
#include "seed/draw/wall.h"
#include "seed/fragment_ids.h"
#include "seed/impacts.h"
#include "seed/leaf_densities.h"
#include "seed/split_impacts.h"
#include "surface/exact/exact_meshes.h"
#include "surface/exact/settled_labels.h"
#include "surface/extract.h"
#include "voxelize/region.h"
#include "voxelize/wall_middles.h"

namespace sherd {
namespace {

// Returns the longest side in voxels: of the mesh's box, or that of a solid without a mesh.
double longestSideVoxels(const Solid& solid) {
  if (!solid.region) return solid.box.longestSide();
  const glm::dvec3& sides = solid.region->sides();
  return std::max({sides.x, sides.y, sides.z});
}

// Returns how many fragments to withhold: `missing` is a share below 1, else a count.
std::size_t withheldCount(double missing, std::size_t fragments) {
  const double count =
      missing < 1.0 ? std::floor(missing * static_cast<double>(fragments) + 0.5) : missing;
  if (count < 0.0 || count > static_cast<double>(fragments) - 1.0) {
    throw Error(ErrorCode::usage, "of " + std::to_string(fragments) + " fragments at most " +
                                      std::to_string(fragments - 1) + " can be withheld");
  }
  return static_cast<std::size_t>(count);
}

// Returns the new id of each old one, and the number of fragments with fewer than `minVoxels`
// voxels.  These get the last ids; the others keep their order.
std::pair<std::vector<std::uint16_t>, std::size_t> idsWithSmallLast(
    const std::vector<std::uint64_t>& voxels, double minVoxels) {
  std::vector<std::uint16_t> ids(1, 0), small;
  for (std::size_t id = 1; id < voxels.size(); ++id) {
    const bool isSmall = static_cast<double>(voxels[id]) < minVoxels;
    (isSmall ? small : ids).push_back(static_cast<std::uint16_t>(id));
  }
  ids.insert(ids.end(), small.begin(), small.end());
  std::vector<std::uint16_t> newIds(voxels.size());
  for (std::size_t i = 0; i < ids.size(); ++i) newIds[ids[i]] = static_cast<std::uint16_t>(i);
  return {std::move(newIds), small.size()};
}

void renumber(Labels& labels, const std::vector<std::uint16_t>& newIds) {
  for (std::uint16_t& label : labels.fragment) {
    if (label != Labels::kEroded) label = newIds[label];
  }
  for (Seed& seed : labels.sites.seeds) seed.fragment = newIds[seed.fragment];
  for (Split& split : labels.splits) {
    split.fragment = newIds[split.fragment];
    split.added = newIds[split.added];
  }
}

// Gives new ids, [fragments + 1] of the old ones, to all that has them.
void renumberAll(GrownFracture& grown, const std::vector<std::uint16_t>& newIds) {
  FractureResult& result = grown.result;
  renumber(result.labels, newIds);
  if (grown.uneroded) renumber(*grown.uneroded, newIds);
  for (Seed& seed : result.seeds) seed.fragment = newIds[seed.fragment];
  std::vector<std::uint64_t> eroded(result.eroded.size());
  for (std::size_t id = 0; id < eroded.size(); ++id) eroded[newIds[id]] = result.eroded[id];
  result.eroded = std::move(eroded);
}

// Gives the last ids to fragments below `dropShare` of the solid; returns their number.
std::size_t dropSmall(GrownFracture& grown, double dropShare) {
  if (!(dropShare >= 0.0 && dropShare <= 1.0)) {
    throw Error(ErrorCode::usage, "the share below which fragments are dropped must lie in 0..1");
  }
  if (dropShare == 0.0) return 0;
  FractureResult& result = grown.result;
  const Solid& solid = result.solid;
  const auto [newIds, small] =
      idsWithSmallLast(countVoxels(result.labels), dropShare * static_cast<double>(solid.voxels));
  if (small == 0) return 0;
  if (small == static_cast<std::size_t>(result.labels.fragmentCount)) {
    throw Error(ErrorCode::usage, "each of the " + std::to_string(small) +
                                      " fragments is too small to be kept; lower the share below "
                                      "which they are dropped");
  }
  renumberAll(grown, newIds);
  return small;
}

// Gives the last ids of the first `fragments` to those that are withheld by their contacts, and
// those that are kept random ones, so that ids do not depend on contacts.
void withhold(GrownFracture& grown, std::size_t fragments, std::size_t count, MissingRule rule) {
  const Labels& labels = grown.uneroded ? *grown.uneroded : grown.result.labels;
  const std::vector<CrackArea> contacts = crackAreas(labels);
  std::vector<bool> isWithheld(fragments + 1, false);
  if (rule == MissingRule::neighbors) {
    isWithheld = withheldByContacts(fragments, count, contacts);
  } else {
    std::fill(isWithheld.end() - static_cast<std::ptrdiff_t>(count), isWithheld.end(), true);
  }
  if (fragments - count > 1) grown.result.alone = aloneByContacts(isWithheld, contacts);
  const auto kept = isWithheld.begin() + static_cast<std::ptrdiff_t>(fragments - count + 1);
  if (std::find(isWithheld.begin() + 1, kept, true) == kept) return;  // the last ones
  std::vector<std::uint16_t> newIds(static_cast<std::size_t>(labels.fragmentCount) + 1);
  std::iota(newIds.begin(), newIds.end(), std::uint16_t{0});
  const std::vector<std::uint16_t> keptIds = permutedIds(
      fragments - count, randomBits(grown.seed, Stage::fragmentId, std::uint64_t{1} << 32));
  std::size_t next = 0;
  auto last = static_cast<std::uint16_t>(fragments - count);
  for (std::size_t id = 1; id <= fragments; ++id)
    newIds[id] = isWithheld[id] ? ++last : keptIds[next++];
  renumberAll(grown, newIds);
}

}  // namespace

Surface surfaceOf(const FractureOptions& options) {
  const bool isAutomatic = options.surface.surface == Surface::automatic;
  const bool isEroded = options.erode.on == ErodeOn::all && !options.erode.iterations.isZero();
  return isAutomatic && isEroded ? Surface::smooth : surfaceOf(options.surface);
}

ShareOptions sharesOf(const FractureOptions& options) {
  ShareOptions shares = options.shares;
  const bool isHit = !options.seeds.impacts.empty() || options.seeds.randomImpacts > 0;
  if (!isHit || options.material == MaterialPreset::none) return shares;
  const ShareOptions own = materialOptions(options.material).shares;
  if (shares.sizes == own.sizes && shares.sizeParameter == own.sizeParameter) {
    shares.sizes = Sizes::grown;
    shares.sizeParameter = 0.0;
  }
  return shares;
}

void checkOptions(const FractureOptions& options) {
  if (options.surface.surface == Surface::exact && options.erode.on == ErodeOn::all &&
      !options.erode.iterations.isZero()) {
    throw Error(ErrorCode::usage,
                "an exact surface stays as it is; erode only fracture surfaces with it",
                OptionNames{"erode-on", "surface"});
  }
  if (!options.guides.empty() && !ruleOf(options.grow.growth).splits) {
    throw Error(ErrorCode::usage, "guides are the first splits of a growth that splits the solid",
                OptionNames{"guide", "growth"});
  }
  const SeedOptions none;
  if (options.seeds.pieces == none.pieces && options.seeds.seed == none.seed &&
      options.grow.noiseSeeds.empty() && options.grow.noiseAnchors.empty() &&
      options.grow.walls.empty() && options.grow.longestSideVoxels == 0.0 &&
      options.erode.longestSideVoxels == 0.0 && options.erode.seed == 0 &&
      options.erode.least == 1) {
    return;
  }
  throw Error(
      ErrorCode::usage,
      "pieces, seed, longest side and least voxels are those of the whole fracture; those of a "
      "stage must not be set");
}

SeedOptions seedOptionsFor(const FractureOptions& options, std::uint64_t seed) {
  SeedOptions seeds = options.seeds;
  seeds.pieces = options.pieces;
  seeds.seed = seed;
  return seeds;
}

namespace {

// What SeedsOn::automatic is.  Growths by splits rotate cracks into walls wherever there are any.
SeedsOn seedsOnFor(const FractureOptions& options, const Solid& solid, std::size_t fragments) {
  const SeedsOn on = resolved(options.seeds.on, solid, fragments);
  const bool isAutomatic = options.seeds.on == SeedsOn::automatic && on != SeedsOn::wall;
  return isAutomatic && ruleOf(options.grow.growth).splits ? SeedsOn::automatic : on;
}

// Returns the middle of the walls that cells of seeds follow, or null.
std::shared_ptr<const WallMiddles> middlesFor(const FractureOptions& options, const Solid& solid,
                                              std::size_t fragments, SolidWalls& walls,
                                              const Progress* progress) {
  if (!givesCells(options.grow)) return nullptr;
  const bool isWall = seedsOnFor(options, solid, fragments) == SeedsOn::wall;
  return isWall ? walls.middles(progress) : nullptr;
}

GuideSides sidesOf(std::span<const Guide> guides, const Solid& solid, const Progress* progress) {
  if (guides.empty()) return {};
  GuideSides sides;
  GuideSurfaces surfaces = guideSurfacesOf(guides, solid, progress);
  sides.guide = std::move(surfaces.guide);
  sides.cracks = std::make_shared<const GivenCracks>(std::move(surfaces.surfaces), solid.frame);
  for (const SidedMesh& surface : sides.cracks->surfaces()) {
    sides.positive.push_back(positiveSide(*solid.blocks, solid.frame, surface, progress));
  }
  return sides;
}

}  // namespace

namespace {

SequentialFracture sequentialOf(const FractureOptions& options, const Solid& solid,
                                const VoxelComponents& components, std::uint64_t seed) {
  const std::size_t fragments = countFragments(components, options.pieces);
  SeedOptions seeds = seedOptionsFor(options, seed);
  for (Impact& impact : seeds.impacts) {
    // Splits have no seeds that could scatter: as many pieces come of the pattern of an energy.
    if (impact.count > 0 && impact.energy == 0.0 && !impact.merge) impact.energy = 1.0;
  }
  return {fragments, seed, leafDensities(solid, components, seeds, fragments),
          splitImpacts(solid, components, seeds, fragments), seedsOnFor(options, solid, fragments)};
}

}  // namespace

namespace {

// Raises fragments that are too small where no least share is asked for.
void raiseSmall(Labels& labels, std::vector<Seed>& seeds, const FractureOptions& options,
                Device& device) {
  if (options.shares.minShare != kAutoShare) return;
  const LeafBlocks& blocks = *labels.blocks;
  const auto fragments = static_cast<std::size_t>(labels.fragmentCount);
  const auto changed = raiseSmallFragments(labels, leastVoxelsOf(blocks.insideVoxels(), fragments));
  if (changed.empty()) return;
  for (const auto& [id, place] : changed) {
    if (place == kNoVoxel) continue;
    const auto own = std::find_if(seeds.begin(), seeds.end(),
                                  [&, id = id](const Seed& seed) { return seed.fragment == id; });
    if (own != seeds.end()) *own = {.voxel = blocks.voxelAt(place), .fragment = id};
  }
  labels = extendLabels(std::move(labels), device, options.grow.outerSteps);
}

// The solids and guides by which splits are decided elsewhere, if they are.
class Elsewhere {
 public:
  ///   other  kept by reference, or null
  Elsewhere(const OtherSolid* other, std::span<const Guide> guides, const Progress* progress) {
    if (other == nullptr) return;
    sides_ = sidesOf(guides, other->solid, progress);
    deciding_.emplace(
        DecidingSolid{other->solid, *other->walls, other->components, sides_, other->component});
  }
  Elsewhere(const Elsewhere&) = delete;
  Elsewhere& operator=(const Elsewhere&) = delete;

  [[nodiscard]] const DecidingSolid* orNull() const { return deciding_ ? &*deciding_ : nullptr; }

 private:
  GuideSides sides_;
  std::optional<DecidingSolid> deciding_;
};

// Returns a fracture by splits, decided on the other solid where that resolves its pieces.
SequentialFracture sequentialOn(const FractureOptions& options, const Solid& solid,
                                const VoxelComponents& components, std::uint64_t seed,
                                const OtherSolid* other) {
  const bool isElsewhere =
      other != nullptr && other->resolves(countFragments(other->components, options.pieces));
  SequentialFracture fracture = isElsewhere
                                    ? sequentialOf(options, other->solid, other->components, seed)
                                    : sequentialOf(options, solid, components, seed);
  fracture.isDecidedElsewhere = isElsewhere;
  return fracture;
}

SeededLabels splitFor(const FractureOptions& options, const Solid& solid,
                      const VoxelComponents& components, std::uint64_t seed, SolidWalls& walls,
                      Device& device, const GrowOptions& grow, const OtherSolid* other,
                      const Progress* progress) {
  const SequentialFracture fracture = sequentialOn(options, solid, components, seed, other);
  const Elsewhere elsewhere(other, options.guides, progress);
  return std::move(growSequential(solid, walls, components, std::span(&fracture, 1), device, grow,
                                  sharesOf(options), sidesOf(options.guides, solid, progress),
                                  elsewhere.orNull(), progress)
                       .front());
}

// Returns the voxel that roughness leaves where it is: that of the first impact.
std::optional<openvdb::Coord> anchorOf(const FractureOptions& options, const Solid& solid) {
  if (options.grow.roughness.isZero()) return {};
  const std::optional<glm::dvec3> center = firstImpact(solid, options.seeds);
  if (!center) return {};
  const glm::dvec3 voxel = glm::round(*center);
  return openvdb::Coord(static_cast<int>(voxel.x), static_cast<int>(voxel.y),
                        static_cast<int>(voxel.z));
}

SeededLabels grownFor(const FractureOptions& options, const Solid& solid,
                      const VoxelComponents& components, std::vector<Seed> seeds,
                      std::uint64_t seed, SolidWalls& walls, Device& device,
                      const Progress* progress, const OtherSolid* other) {
  GrowOptions grow = options.grow;
  grow.noiseSeeds = {randomBits(seed, Stage::noise, 0)};
  grow.noiseAnchors = {anchorOf(options, solid)};
  grow.longestSideVoxels =
      other != nullptr ? other->side / solid.frame.voxelSize : longestSideVoxels(solid);
  if (ruleOf(grow.growth).splits) {
    return splitFor(options, solid, components, seed, walls, device, grow, other, progress);
  }
  const auto fragments = static_cast<std::size_t>(fragmentsOf(seeds));
  grow.walls = {middlesFor(options, solid, fragments, walls, progress)};
  return growWithShares(solid, components, std::move(seeds), device,
                        {grow, sharesOf(options), seed, options.seeds.density.field.get()},
                        progress);
}

}  // namespace

SeededLabels growFor(const FractureOptions& options, const Solid& solid,
                     const VoxelComponents& components, std::vector<Seed> seeds, std::uint64_t seed,
                     SolidWalls& walls, Device& device, const Progress* progress,
                     const OtherSolid* other) {
  SeededLabels grown =
      grownFor(options, solid, components, std::move(seeds), seed, walls, device, progress, other);
  raiseSmall(grown.labels, grown.seeds, options, device);
  return grown;
}

namespace {

// Prefixes what is wrong with the seeds by the name of their file.
std::vector<Seed> seedsAt(const GivenSeeds& given, const PreparedSolid& ready, std::uint64_t seed) {
  try {
    return seedsFromPoints(given.points, ready.solid, ready.components, seed);
  } catch (const Error& e) {
    if (given.file.empty()) throw;
    throw Error(e.code(), given.file + ": " + e.what(), e.options());
  }
}

// Returns a fracture with its solid and seeds.
GrownFracture seeded(const PreparedSolid& ready, const FractureOptions& options,
                     const Progress* progress) {
  GrownFracture grown;
  FractureResult& result = grown.result;
  grown.surface = ready.surface;
  grown.seed = options.seed;
  result.solid = ready.solid;
  result.components = ready.components.count();
  const std::optional<GivenSeeds>& given = options.seeds.given;
  const bool splits = ruleOf(options.grow.growth).splits;
  if (given && splits) {
    throw Error(ErrorCode::usage, "a growth that splits the solid has no seeds that can be given",
                OptionNames{"seeds", "growth"});
  }
  requireNearImpacts(ready.solid, options.seeds.impacts);
  if (given) {
    result.seeds = seedsAt(*given, ready, options.seed);
    result.seedsOn =
        seedsOnFor(options, ready.solid, static_cast<std::size_t>(fragmentsOf(result.seeds)));
  } else if (!splits) {
    SeedOptions seeds = seedOptionsFor(options, options.seed);
    seeds.on = seedsOnFor(options, ready.solid, countFragments(ready.components, options.pieces));
    result.seeds = placeSeeds(result.solid, ready.components, seeds, progress);
    result.seedsOn = seeds.on;
  } else {
    result.seedsOn =
        seedsOnFor(options, ready.solid, countFragments(ready.components, options.pieces));
  }
  const std::size_t fragments = splits ? countFragments(ready.components, options.pieces)
                                       : static_cast<std::size_t>(fragmentsOf(result.seeds));
  (void)withheldCount(options.missing, fragments);  // checks before long work
  (void)passesOf(options.erode, longestSideVoxels(ready.solid));
  return grown;
}

// Erodes the grown labels and gives the withheld fragments the last ids.
void finish(GrownFracture& grown, Labels labels, const FractureOptions& options, Device& device,
            StageClock clock, const Progress* progress) {
  FractureResult& result = grown.result;
  const auto fragments = static_cast<std::size_t>(labels.fragmentCount);
  ErodeOptions erosion = options.erode;
  erosion.seed = options.seed;
  erosion.longestSideVoxels = longestSideVoxels(result.solid);
  if (options.shares.minShare != 0.0) {
    erosion.least = leastVoxelsOf(result.solid.voxels, fragments);
  }
  if (passesOf(erosion, erosion.longestSideVoxels).count > 0) {
    Erosion eroded = erode(labels, erosion, device, progress);
    result.labels = extendLabels(std::move(eroded.labels), device, options.grow.outerSteps);
    result.eroded = std::move(eroded.eroded);
    grown.uneroded = std::move(labels);
    clock.done("erode");
  } else {
    result.labels = std::move(labels);
    result.eroded.assign(fragments + 1, 0);
  }
  grown.least = options.shares.minShare == kAutoShare
                    ? leastVoxelsOf(result.solid.voxels, fragments)
                    : leastVoxels(options.shares, result.solid.voxels);
  const std::size_t small = dropSmall(grown, options.dropShare);
  const std::size_t missing = withheldCount(options.missing, fragments - small);
  if (missing > 0) withhold(grown, fragments - small, missing, options.missingRule);
  result.withheld = small + missing;
  result.times = clock.times();
}

// Grows fractures by splits, and sets their seeds.
std::vector<Labels> splitTogether(const PreparedSolid& ready, std::vector<GrownFracture>& all,
                                  std::span<const FractureOptions> options,
                                  const GrowOptions& together, SolidWalls& walls, Device& device,
                                  const Progress* progress) {
  const auto solids = ready.deciding ? ready.deciding : std::make_shared<DecidingSolids>();
  const OtherSolid* const other = solids->of(ready.solid, ready.components, device, progress);
  std::vector<SequentialFracture> fractures;
  for (const FractureOptions& own : options) {
    fractures.push_back(sequentialOn(own, ready.solid, ready.components, own.seed, other));
    all[fractures.size() - 1].result.seedsOn = fractures.back().on;
  }
  const std::vector<Guide>& guides = options.front().guides;
  const GuideSides sides = sidesOf(guides, ready.solid, progress);
  const Elsewhere elsewhere(other, guides, progress);
  std::vector<Labels> labels;
  for (SeededLabels& grown :
       growSequential(ready.solid, walls, ready.components, fractures, device, together,
                      sharesOf(options.front()), sides, elsewhere.orNull(), progress)) {
    FractureResult& result = all[labels.size()].result;
    result.guideWarnings =
        guideWarnings(guides, grown.guide, grown.guided, grown.labels.splits.size());
    result.seeds = std::move(grown.seeds);
    result.sizeError = grown.sizeError;
    labels.push_back(std::move(grown.labels));
  }
  return labels;
}

}  // namespace

std::vector<GrownFracture> growTogether(const PreparedSolid& ready,
                                        std::span<const FractureOptions> options, Device& device,
                                        StageClock clock, const Progress* progress) {
  std::vector<GrownFracture> all;
  std::vector<std::vector<Seed>> seeds;
  GrowOptions together = options.front().grow;
  together.longestSideVoxels = longestSideVoxels(ready.solid);
  for (const FractureOptions& own : options) {
    checkOptions(own);
    all.push_back(seeded(ready, own, progress));
    seeds.push_back(all.back().result.seeds);
    together.noiseSeeds.push_back(randomBits(own.seed, Stage::noise, 0));
    together.noiseAnchors.push_back(anchorOf(own, ready.solid));
  }
  clock.done("seed");
  std::vector<Labels> labels;
  const bool areKept = ready.walls && ready.walls->areOf(ready.solid);
  const auto walls = areKept ? ready.walls : std::make_shared<SolidWalls>(ready.solid);
  if (ruleOf(together.growth).splits) {
    labels = splitTogether(ready, all, options, together, *walls, device, progress);
  } else if (sharesOf(options.front()).isSet()) {
    // How often each has to grow depends on what comes out.
    for (std::size_t i = 0; i < all.size(); ++i) {
      SeededLabels one = growFor(options[i], ready.solid, ready.components, std::move(seeds[i]),
                                 options[i].seed, *walls, device, progress);
      all[i].result.seeds = std::move(one.seeds);
      all[i].result.sizeError = one.sizeError;
      labels.push_back(std::move(one.labels));
    }
  } else {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto fragments = static_cast<std::size_t>(fragmentsOf(seeds[i]));
      together.walls.push_back(middlesFor(options[i], ready.solid, fragments, *walls, progress));
      if (!together.walls.back()) continue;
      seeds[i] =
          withDistinctMiddles(std::move(seeds[i]), *ready.solid.blocks, *together.walls.back());
      all[i].result.seeds = seeds[i];
    }
    labels = grow(ready.solid.blocks, seeds, device, together, progress);
  }
  clock.done("grow");
  for (std::size_t i = 0; i < all.size(); ++i) {
    raiseSmall(labels[i], all[i].result.seeds, options[i], device);
    finish(all[i], std::move(labels[i]), options[i], device, clock, progress);
  }
  return all;
}

GrownFracture grow(const PreparedSolid& ready, const FractureOptions& options, Device& device,
                   StageClock clock, const Progress* progress) {
  return std::move(
      growTogether(ready, std::span(&options, 1), device, std::move(clock), progress).front());
}

namespace {

std::shared_ptr<const FragmentSurfaces> surfacesOf(const GrownFracture& grown,
                                                   const FractureResult& result,
                                                   const SurfaceOptions& options,
                                                   const Progress* progress) {
  auto surfaces = std::make_shared<FragmentSurfaces>(
      result.solid, result.labels, grown.unerodedOrNull(), grown.surface, progress);
  surfaces->displacePoints(SurfaceNoise(options, result.solid, grown.seed), progress);
  return surfaces;
}

}  // namespace

void settle(GrownFracture& grown, const SurfaceOptions& options, const Progress* progress) {
  FractureResult& result = grown.result;
  const bool isExact = surfaceOf(options) == Surface::exact &&
                       (options.surface == Surface::exact || result.solid.mesh != nullptr);
  if (!isExact || grown.exact) return;
  checkSurfaceOptions(options);
  reportProgress(progress, "extract", 0.0);
  const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(result.solid.blocks->origins);
  const Labels* const uneroded = grown.unerodedOrNull();
  if (grown.isSettled) {
    grown.exact = exactMeshes(result.solid, result.labels, uneroded, neighborhoods,
                              crackAdaptivity(options), progress);
  } else {
    grown.exact = settledExactMeshes(result.solid, result.labels, uneroded, grown.least,
                                     neighborhoods, crackAdaptivity(options), progress);
  }
  grown.isSettled = true;
}

void measureFragments(const GrownFracture& grown, FractureResult& result,
                      const SurfaceOptions& options, const Progress* progress) {
  reportProgress(progress, "extract", 0.0);
  result.surfaces = surfacesOf(grown, result, options, progress);
  result.fragments = measuredFragments(*result.surfaces, result.solid, result.labels,
                                       grown.unerodedOrNull(), progress);
  reportProgress(progress, "extract", 1.0);
}

FractureResult extracted(GrownFracture grown, const FractureOptions& options,
                         const Progress* progress) {
  FractureResult& result = grown.result;
  StageClock clock(std::move(result.times));
  if (options.surface.meshes) {
    SurfaceOptions surface = options.surface;
    if (surfaceOf(options) == Surface::smooth) surface.surface = Surface::smooth;
    settle(grown, surface, progress);
    ExtractedFragments all =
        extractAll(result.solid, result.labels, grown.extractOptions(surface), progress);
    result.fragments = std::move(all.fragments);
    result.exactFailure = std::move(all.exactFailure);
    result.smooth = std::move(all.smooth);
    result.united = std::move(all.united);
    result.surfaces = std::move(all.surfaces);
    result.unmerged = std::move(all.unmerged);
  } else {
    checkSurfaceOptions(options.surface);
    measureFragments(grown, result, options.surface, progress);
  }
  clock.done("extract");
  result.times = clock.times();
  return std::move(result);
}

}  // namespace sherd
