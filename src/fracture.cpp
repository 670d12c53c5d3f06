// The stages in order, timed.
#include <sherd/fracture.h>

#include <chrono>

#include "voxelize/specks.h"

namespace sherd {

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
  const std::vector<Seed> seeds =
      placeSeeds(result.solid.blocks, parts, {.pieces = options.pieces, .seed = options.seed});
  done("seed");
  result.labels =
      std::move(grow(result.solid.blocks, std::span(&seeds, 1), device, {}, progress).front());
  done("grow");
  result.fragments =
      extractFragments(result.solid, result.labels, static_cast<int>(seeds.size()), progress);
  done("extract");
  return result;
}

}  // namespace sherd
