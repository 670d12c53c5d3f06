// Presets of options.
#include <sherd/fracture.h>

namespace sherd {

// Sets every option that the paper specifies, including defaults, which may change.
FractureOptions paperOptions() {
  constexpr Iterations kIterations{.perVoxel = 0.048};
  FractureOptions options;
  options.solid.resolution = 128;
  options.solid.fill = Fill::automatic;
  options.seeds.sampler = Sampler::uniform;
  options.seeds.on = SeedsOn::volume;
  options.seeds.extraSeeds = 0;
  options.seeds.extraSeedsPerPiece = 2;
  options.seeds.mergeMetric = Metric::chebyshev;
  options.seeds.randomImpacts = 0;
  options.grow.growth = Growth::flood;
  options.grow.neighborhood = 6;
  options.grow.roughness = 0.0;
  options.grow.regrowIsolated = true;
  options.shares = {.minShare = 0.0};
  options.erode.iterations = 0;
  options.missing = 0.0;
  options.surface = {.surface = Surface::labels,
                     .smooth = {.iterations = kIterations,
                                .weight = 0.9,
                                .boundaryIterations = kIterations,
                                .boundaryWeight = 0.2,
                                .method = Smoothing::laplacian},
                     .adaptivity = 0.0};
  return options;
}

FractureOptions trainingOptions() {
  FractureOptions options;
  options.seeds.extraSeedsPerPiece = 2;
  options.seeds.sizeSpread = 1.0;
  options.shares.minShare = 0.002;
  options.surface.interface = Interface::independent;
  return options;
}

}  // namespace sherd
