// Refracture: each broken fragment is a separate solid for seeds and growth; the cut is then
// recomputed for all fragments together.
#include <sherd/error.h>
#include <sherd/fracture.h>
#include <sherd/growth.h>

#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "base/random.h"
#include "grow/fields/small_components.h"
#include "pipeline/deciding.h"
#include "pipeline/fracture_stages.h"
#include "pipeline/guide_surfaces.h"
#include "pipeline/refracture_islands.h"
#include "pipeline/refracture_meshes.h"
#include "seed/draw/candidates.h"
#include "seed/draw/voxel_index.h"
#include "seed/draw/wall.h"
#include "seed/fragment_ids.h"
#include "surface/label_mesh.h"
#include "voxelize/canonical_solid.h"
#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/voxelize.h"
#include "voxelize/wall_middles.h"

namespace sherd {
namespace {

// Returns a fragment as a solid over the same leaves.
//   hasBand  with an exterior band, which exact surfaces need
Solid solidOf(const FinishedFracture& finished, int id, bool hasBand) {
  LeafBlocks blocks = blocksOf(finished, id);
  if (hasBand) setExteriorBand(blocks);
  Solid fragment = finished.solid;
  fragment.region = nullptr;  // it holds for the whole
  fragment.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  measureVoxels(fragment);
  return fragment;
}

// Returns the closed mesh of a fragment: its own, or without one the faces of its voxels.
TriangleMesh closedMeshOf(const FinishedFracture& finished, const Solid& fragment, int id) {
  TriangleMesh own = meshOf(finished, id).mesh;
  if (!own.triangles.empty() && openEdges(own) == 0) return own;
  if (fragment.box.longestSide() <= 1.25 * CanonicalSolid::kResolution) return {};
  std::vector<std::uint32_t> leaves(finished.solid.blocks->count());
  std::iota(leaves.begin(), leaves.end(), 0u);
  return meshOfFaces(facesOf(finished.solid, finished.labels, finished.labels,
                             static_cast<std::uint16_t>(id), leaves),
                     finished.solid.frame);
}

// Returns the solid on which cracks through a fragment are decided, whatever its voxels.  Sides of
// its grid are parts of the whole's, in steps that the rounding of a mesh seldom changes.
//   mesh  of the fragment, closed, or empty
std::optional<OtherSolid> otherOfFragment(const FinishedFracture& finished, const Solid& fragment,
                                          const TriangleMesh& mesh,
                                          const VoxelComponents& components, Device& device,
                                          const Progress* progress) {
  if (mesh.triangles.empty() || !(volume(mesh) > 0.0)) return {};
  constexpr double kStepsPerOctave = 4.0;
  const double whole = finished.resolution * finished.solid.frame.voxelSize;
  const double steps = std::floor(kStepsPerOctave * std::log2(whole / longestSide(bounds(mesh))));
  const double side = whole * std::exp2(-steps / kStepsPerOctave);
  return decidingSolid(fragment, components, mesh, side, device, progress);
}

// Returns seeds of one solid on the voxels of another that is in the same place; none where one of
// them has no voxel there.
std::vector<Seed> seedsOn(const Solid& solid, std::span<const Seed> seeds,
                          const VoxelScale& scale) {
  const VoxelIndex voxels(*solid.blocks, solid.blocks->inside);
  const double reach = 2.0 + 2.0 * scale.ratio;
  std::set<VoxelKey> taken;
  std::vector<Seed> out;
  for (Seed seed : seeds) {
    const glm::dvec3 at = scale.position(pointOf(seed));
    const auto found =
        voxels.nearestWithin(at, reach, [&](VoxelKey key) { return !taken.contains(key); });
    if (!found) return {};
    taken.insert(*found);
    seed.voxel = voxels.voxelAt(*found);
    seed.shift = shiftOf(at, seed.voxel);
    out.push_back(seed);
  }
  return out;
}

// Returns the seeds of a fragment's parts: those of its mesh, if it has one and is connected.
//   mesh   of the fragment
//   other  of the mesh, or null
std::vector<Seed> seedsOf(const Solid& fragment, const VoxelComponents& components,
                          SeedOptions options, const TriangleMesh& mesh, const OtherSolid* other,
                          Device& device, const Progress* progress) {
  const auto resolve = [&](const Solid& solid) {
    options.on = resolved(options.on, solid, countFragments(components, options.pieces));
  };
  if (other != nullptr && components.count() == 1) {
    // In a grid of its own, so that points are drawn in the mesh's box.
    const PreparedSolid own = prepared(
        voxelizeAlone(mesh, {.voxelSize = other->solid.frame.voxelSize, .keepSeams = false}, 1.0,
                      progress),
        device);
    if (own.components.count() == 1) {
      resolve(own.solid);
      std::vector<Seed> seeds =
          seedsOn(fragment, placeSeeds(own.solid, own.components, options, progress),
                  VoxelScale::between(own.solid.frame, fragment.frame));
      if (!seeds.empty()) return seeds;
    }
  }
  resolve(fragment);
  return placeSeeds(fragment, components, options, progress);
}

//   walls  of the whole solid
SeededLabels breakFragment(const FinishedFracture& finished, const Solid& fragment, int id,
                           const FractureOptions& options, SolidWalls& walls, Device& device,
                           const Progress* progress) {
  const std::uint64_t seed =
      randomBits(options.seed, Stage::refracture, static_cast<std::uint64_t>(id));
  const VoxelComponents components = findComponents(*fragment.blocks, device);
  const bool splits = ruleOf(options.grow.growth).splits;
  const TriangleMesh mesh = closedMeshOf(finished, fragment, id);
  const std::optional<OtherSolid> found =
      otherOfFragment(finished, fragment, mesh, components, device, progress);
  const OtherSolid* const other = found ? &*found : nullptr;
  FractureOptions own = options;
  if (own.grow.roughnessWindow.isZero()) {  // a tenth of the fragment, not of the whole mesh
    const double side =
        other != nullptr ? other->side / fragment.frame.voxelSize : fragment.box.longestSide();
    own.grow.roughnessWindow = side / 10.0;
  }
  std::vector<Seed> seeds;
  if (!splits) {
    seeds = seedsOf(fragment, components, seedOptionsFor(own, seed), mesh, other, device, progress);
  }
  // Splits follow the fragment's own surface, old cracks included.
  SolidWalls ownWalls(fragment);
  return growFor(own, fragment, components, std::move(seeds), seed, splits ? ownWalls : walls,
                 device, progress, other);
}

// The splits of all broken fragments: a guide does something if it divides one of them.
struct GuidedSplits {
  std::vector<std::size_t> guide{}, cracks{};  // as SeededLabels::guide and guided
  std::size_t splits = 0;

  void add(const SeededLabels& grown) {
    guide = grown.guide;  // the same of all
    cracks.insert(cracks.end(), grown.guided.begin(), grown.guided.end());
    splits += grown.labels.splits.size();
  }
};

std::set<int> existingIds(std::span<const int> given, int fragments) {
  std::set<int> ids(given.begin(), given.end());
  for (const int id : ids) {
    if (id < 1 || id > fragments) {
      throw Error(ErrorCode::usage, "there is no fragment " + std::to_string(id) +
                                        ", the fracture has 1.." + std::to_string(fragments));
    }
  }
  return ids;
}

// Gives ids to the parts of broken fragments: the first part of each keeps the fragment's id, so
// that ids have no gaps and those of all other fragments stay; the others follow the last id.
class PartIds {
 public:
  explicit PartIds(int fragments) : parents_(static_cast<std::size_t>(fragments)) {
    std::iota(parents_.begin(), parents_.end(), 1);
  }

  // Returns [parts + 1] the ids of a fragment's parts.
  std::vector<std::uint16_t> of(int broken, int parts) {
    if (parents_.size() + static_cast<std::size_t>(parts) - 1 > kMaxFragments) {
      throw Error(ErrorCode::usage,
                  "there would be more than " + std::to_string(kMaxFragments) + " fragments");
    }
    std::vector<std::uint16_t> ids{0, static_cast<std::uint16_t>(broken)};
    for (int part = 2; part <= parts; ++part) {
      parents_.push_back(broken);
      ids.push_back(static_cast<std::uint16_t>(parents_.size()));
    }
    return ids;
  }

  // Returns [fragments] the old fragment that each is, or is a part of.
  std::vector<int> parents() && { return std::move(parents_); }

 private:
  std::vector<int> parents_;
};

}  // namespace

GrownFracture regrown(const FinishedFracture& read, std::span<const int> only,
                      const FractureOptions& options, Device& device, const Progress* progress) {
  checkOptions(options);
  const std::set<int> broken = existingIds(only, read.labels.fragmentCount);
  const std::optional<FinishedFracture> connected = withoutIslands(read, broken, device);
  const FinishedFracture& finished = connected ? *connected : read;
  StageClock clock;
  GrownFracture all;
  all.seed = options.seed;
  FractureResult& result = all.result;
  result.solid = finished.solid;
  result.components = findComponents(*finished.solid.blocks, device).count();
  result.labels.blocks = finished.solid.blocks;
  result.labels.fragment.assign(finished.labels.fragment.size(), 0);
  finished.solid.blocks->forEachInside([&](std::size_t voxelIndex) {
    result.labels.fragment[voxelIndex] = finished.labels.fragment[voxelIndex];
  });
  PartIds ids(finished.labels.fragmentCount);
  const bool isExact = options.surface.surface == Surface::automatic
                           ? read.isExact && surfaceOf(options) == Surface::exact
                           : options.surface.surface == Surface::exact;
  std::vector<BrokenFragment> parts;
  GuidedSplits guided;
  SolidWalls walls(finished.solid);
  for (const int id : broken) {
    Solid fragment = solidOf(finished, id, isExact);
    SeededLabels grown = breakFragment(finished, fragment, id, options, walls, device, progress);
    guided.add(grown);
    std::vector<std::uint16_t> own = ids.of(id, fragmentsOf(grown.seeds));
    for (Seed seed : grown.seeds) {
      seed.fragment = own[seed.fragment];
      result.seeds.push_back(seed);
    }
    clock.done("grow");
    BrokenFragment part{id, std::move(own), std::move(fragment), std::move(grown.labels)};
    if (isExact) cutAgain(finished, part, options.surface.adaptivity, progress);
    clock.done("extract");
    part.solid.blocks->forEachInside([&](std::size_t voxelIndex) {
      result.labels.fragment[voxelIndex] = part.ids[part.labels.fragment[voxelIndex]];
    });
    if (isExact) parts.push_back(std::move(part));
  }
  result.parents = std::move(ids).parents();
  result.broken.assign(broken.begin(), broken.end());
  result.history = finished.history;
  result.guideWarnings = guideWarnings(options.guides, guided.guide, guided.cracks, guided.splits);
  result.labels.fragmentCount = static_cast<int>(result.parents.size());
  result.labels = extendLabels(std::move(result.labels), device, options.grow.outerSteps);
  result.eroded.assign(result.parents.size() + 1, 0);
  clock.done("grow");
  if (isExact) {
    all.exact = exactMeshesAgain(finished, parts, result.labels);
    clock.done("extract");
  }
  result.times = clock.times();
  return all;
}

FractureResult refracture(const FinishedFracture& finished, std::span<const int> only,
                          const FractureOptions& options, Device& device,
                          const Progress* progress) {
  FractureResult result =
      extracted(regrown(finished, only, options, device, progress), options, progress);
  if (options.surface.meshes) result.surfaces.reset();
  return result;
}

}  // namespace sherd
