// The stages in order, timed.
#include <sherd/error.h>
#include <sherd/fracture.h>

#include <cmath>
#include <utility>

#include "fracture_stages.h"
#include "voxelize/specks.h"

namespace sherd {
namespace {

std::size_t withheldOf(double missing, std::size_t fragments) {
  const double wanted =
      missing < 1.0 ? std::floor(missing * static_cast<double>(fragments) + 0.5) : missing;
  if (wanted < 0.0 || wanted > static_cast<double>(fragments) - 1.0) {
    throw Error(ErrorCode::usage, "of " + std::to_string(fragments) + " fragments at most " +
                                      std::to_string(fragments - 1) + " can be withheld");
  }
  return static_cast<std::size_t>(wanted);
}

FractureResult breakSolid(Solid solid, const FractureOptions& options, StageClock clock,
                          Device& device, const Progress* progress) {
  FractureResult result;
  Parts parts = findParts(solid.blocks, device);
  result.solid = dropSpecks(std::move(solid), parts, device);
  result.parts = parts.count();
  clock.done("parts");
  const LeafBlocks& blocks = result.solid.blocks;
  result.seeds = options.seedFile.empty()
                     ? placeSeeds(result.solid, parts, seedOptionsFor(options, parts, options.seed))
                     : readSeeds(options.seedFile, result.solid, parts, options.seed);
  const int fragments = fragmentsOf(result.seeds);
  result.withheld = withheldOf(options.missing, static_cast<std::size_t>(fragments));
  clock.done("seed");

  SeededLabels grown =
      growFor(options, blocks, parts, std::move(result.seeds), options.seed, device, progress);
  result.seeds = std::move(grown.seeds);
  clock.done("grow");

  ErodeOptions erosion = options.erode;
  erosion.seed = options.seed;
  const bool wears = erosion.iterations > 0;
  if (wears) {
    Erosion worn = erode(blocks, grown.labels, fragments, erosion, device, progress);
    result.labels = carriedOverBand(blocks, std::move(worn.labels), device);
    result.worn = std::move(worn.worn);
    clock.done("erode");
  } else {
    result.labels = std::move(grown.labels);
    result.worn.assign(static_cast<std::size_t>(fragments) + 1, 0);
  }
  result.fragments = extractFragments(result.solid, result.labels, fragments,
                                      wears ? &grown.labels : nullptr, options.surface, progress);
  clock.done("extract");
  result.times = clock.times();
  return result;
}

}  // namespace

FractureResult fracture(const TriangleMesh& mesh, const FractureOptions& options, Device& device,
                        const Progress* progress) {
  StageClock clock;
  const SolidOptions solidOptions{.resolution = options.resolution,
                                  .voxelSize = options.voxelSize,
                                  .fill = options.fill,
                                  .shellThickness = options.shellThickness};
  Solid solid = voxelize(mesh, solidOptions, progress);
  clock.done("voxelize");
  return breakSolid(std::move(solid), options, clock, device, progress);
}

FractureResult fracture(Solid solid, const FractureOptions& options, Device& device,
                        const Progress* progress) {
  return breakSolid(std::move(solid), options, StageClock(), device, progress);
}

}  // namespace sherd
