// The stages in order, timed.
#include <sherd/error.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "random.h"
#include "voxelize/specks.h"

namespace sherd {
namespace {

std::vector<Seed> seedsFor(const Solid& solid, const Parts& parts, const FractureOptions& options) {
  if (!options.seedFile.empty()) return readSeeds(options.seedFile, solid, parts, options.seed);
  SeedOptions seeds = options.seeds;
  seeds.pieces = options.pieces;
  seeds.seed = options.seed;
  const int fragments = std::max(options.pieces, static_cast<int>(parts.count()));
  seeds.extraSeeds += options.extraSeedsPerPiece * fragments;
  return placeSeeds(solid, parts, seeds);
}

std::size_t withheldOf(double missing, std::size_t fragments) {
  const double wanted =
      missing < 1.0 ? std::floor(missing * static_cast<double>(fragments) + 0.5) : missing;
  if (wanted < 0.0 || wanted > static_cast<double>(fragments) - 1.0) {
    throw Error(ErrorCode::usage, "of " + std::to_string(fragments) + " fragments at most " +
                                      std::to_string(fragments - 1) + " can be withheld");
  }
  return static_cast<std::size_t>(wanted);
}

}  // namespace

FractureResult fracture(const TriangleMesh& mesh, const FractureOptions& options, Device& device,
                        const Progress* progress) {
  FractureResult result;
  auto last = std::chrono::steady_clock::now();
  const auto done = [&](const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    result.times.push_back({stage, std::chrono::duration<double>(now - last).count()});
    last = now;
  };

  result.solid =
      voxelize(mesh, {.resolution = options.resolution, .voxelSize = options.voxelSize}, progress);
  done("voxelize");
  Parts parts = findParts(result.solid.blocks, device);
  result.solid = dropSpecks(std::move(result.solid), parts, device);
  result.parts = parts.count();
  done("parts");
  const LeafBlocks& blocks = result.solid.blocks;
  result.seeds = seedsFor(result.solid, parts, options);
  const int fragments = fragmentsOf(result.seeds);
  result.withheld = withheldOf(options.missing, static_cast<std::size_t>(fragments));
  done("seed");

  GrowOptions grow = options.grow;
  grow.noiseSeeds = {randomBits(options.seed, Stage::noise, 0)};
  const openvdb::Coord dims = result.solid.box.dims();
  if (grow.roughnessWindow <= 0.0) {
    grow.roughnessWindow = std::max({dims.x(), dims.y(), dims.z()}) / 10.0;
  }
  SeededLabels grown = growWithShares(blocks, parts, std::move(result.seeds), device, grow,
                                      options.shares, options.seed, progress);
  result.seeds = std::move(grown.seeds);
  done("grow");

  ErodeOptions erosion = options.erode;
  erosion.seed = options.seed;
  const bool wears = erosion.iterations > 0;
  if (wears) {
    Erosion worn = erode(blocks, grown.labels, fragments, erosion, progress);
    result.labels = carriedOverBand(blocks, std::move(worn.labels), device);
    result.worn = std::move(worn.worn);
    done("erode");
  } else {
    result.labels = std::move(grown.labels);
    result.worn.assign(static_cast<std::size_t>(fragments) + 1, 0);
  }
  result.fragments = extractFragments(result.solid, result.labels, fragments,
                                      wears ? &grown.labels : nullptr, progress);
  done("extract");
  return result;
}

}  // namespace sherd
