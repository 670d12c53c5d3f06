// Random solids and random options for property tests.
#pragma once

#include <sherd/labels.h>

#include <random>

#include "unit/seed/seeds_fixture.h"

namespace sherd::random_case {

using openvdb::Coord;
using voxel_shapes::VoxelSolid;

/// Random numbers that do not depend on the compiler.  Several draws in one expression need braces,
/// which evaluate in order.
class Draw {
 public:
  explicit Draw(std::uint64_t number) : bits_(number + 1) {}

  int upTo(int most) { return most <= 0 ? 0 : static_cast<int>(bits_() % (most + 1ull)); }
  int between(int low, int high) { return low + upTo(high - low); }
  bool oneIn(int n) { return upTo(n - 1) == 0; }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  std::uint64_t seed() { return bits_(); }
  template <class T>
  T of(std::initializer_list<T> these) {
    return these.begin()[upTo(static_cast<int>(these.size()) - 1)];
  }

 private:
  std::mt19937_64 bits_;
};

inline VoxelSolid unionOfBoxesAndBalls(Draw& draw, int extent) {
  struct Primitive {
    Coord center, reach;
    bool isBall;
  };
  std::vector<Primitive> primitives(static_cast<std::size_t>(draw.between(2, 7)));
  for (Primitive& primitive : primitives) {
    for (int axis = 0; axis < 3; ++axis) {
      primitive.center[axis] = draw.between(-extent, extent);
      primitive.reach[axis] = draw.upTo(extent / 2);
    }
    primitive.isBall = draw.oneIn(2);
  }
  return voxel_shapes::solidWhere("boxes and balls", extent, [&](const Coord& v) {
    return std::any_of(primitives.begin(), primitives.end(), [&](const Primitive& primitive) {
      const Coord d = v - primitive.center;
      const int r = primitive.reach.x();
      if (primitive.isBall) return d.x() * d.x() + d.y() * d.y() + d.z() * d.z() <= r * r;
      return std::abs(d.x()) <= r && std::abs(d.y()) <= primitive.reach.y() &&
             std::abs(d.z()) <= primitive.reach.z();
    });
  });
}

inline VoxelSolid shapeFor(Draw& draw, int most) {
  const int extent = draw.between(3, most);
  const auto seed = static_cast<unsigned>(draw.upTo(1000));
  switch (draw.upTo(7)) {
    case 0:
      return voxel_shapes::ball(extent);
    case 1:
      return voxel_shapes::cup(most, draw.between(1, 4));
    case 2:
      return voxel_shapes::sparseRandom(std::min(extent, 9), 5 + seed % 91, seed);
    case 3:
      return voxel_shapes::manyComponentsWithin(extent);
    case 4:
      return voxel_shapes::checkerboard(std::min(extent, 5));
    default:
      return unionOfBoxesAndBalls(draw, most);
  }
}

// A shape at a random position, so that leaf boundaries vary.
inline VoxelSolid anySolid(Draw& draw) {
  VoxelSolid solid;
  while (solid.inside.empty()) solid = shapeFor(draw, voxel_shapes::small() ? 6 : 14);
  const int far = draw.of({0, 8, 20, 1'000'000});
  const Coord by{draw.between(-far, far), draw.between(-far, far), draw.between(-far, far)};
  VoxelSolid moved{solid.name, {}, {}};
  for (const Coord& v : solid.inside) moved.inside.insert(v + by);
  for (const Coord& v : solid.exteriorBand) moved.exteriorBand.insert(v + by);
  return moved;
}

inline Impact anyImpact(Draw& draw, const ShapeSolid& on) {
  const auto anyVoxel = [&] {
    return *std::next(on.shape.inside.begin(), draw.upTo(static_cast<int>(on.solid.voxels) - 1));
  };
  const auto world = [&](const Coord& v) { return on.solid.frame.worldFromIndex(v); };
  Impact impact;
  if (draw.oneIn(3)) impact.target = world(anyVoxel());
  if (draw.oneIn(3)) {  // hits a voxel of the solid
    const glm::dvec3 to = world(anyVoxel());
    const glm::dvec3 from = world(anyVoxel() + Coord{draw.of({-40, 0, 41}), draw.upTo(40), 50});
    impact.target = Ray{from, to - from};
  }
  impact.count = draw.upTo(2);
  if (draw.oneIn(2)) impact.sigma = draw.between(0.01, 3.0);
  impact.bias = draw.between(1, 12);
  impact.merge = draw.oneIn(2);
  return impact;
}

inline SeedOptions anySeeds(Draw& draw, const ShapeSolid& on) {
  SeedOptions options;
  const int components = static_cast<int>(on.components.count());
  options.on = draw.of({SeedsOn::volume, SeedsOn::surface});
  options.pieces = draw.between(1, std::max(1, static_cast<int>(on.solid.voxels / 100)));
  options.seed = draw.seed();
  options.sampler = kSamplers[draw.upTo(3)];
  options.mergeMetric = kMetrics[draw.upTo(2)];
  const int candidates = static_cast<int>(options.on == SeedsOn::volume ? on.shape.inside.size()
                                                                        : on.surface().size());
  const int fragments = std::max(options.pieces, components), room = candidates - fragments;
  if (draw.oneIn(2)) options.extraSeeds = draw.upTo(std::min(3 * fragments, room / 2));
  // Impacts need free voxels; whether the component they hit has enough shows when seeds are
  // placed.
  if (options.pieces - components >= 16 && room > 4 * fragments && !draw.oneIn(3)) {
    for (int i = draw.upTo(3); i > 0; --i) options.impacts.push_back(anyImpact(draw, on));
    options.randomImpacts = draw.upTo(2);
  }
  return options;
}

inline GrowOptions anyGrowth(Draw& draw) {
  GrowOptions options;
  options.growth = draw.of({Growth::flood, Growth::nearest, Growth::chain, Growth::euclid});
  options.neighborhood = draw.of({6, 26});
  options.metric = kMetrics[draw.upTo(2)];
  if (draw.oneIn(3)) {
    options.anisotropy = {
        {draw.between(-1.0, 1.0), draw.between(-1.0, 1.0), draw.between(0.1, 1.0)},
        draw.of({-0.75, 9.0, draw.between(-0.75, 9.0)})};
  }
  if (draw.oneIn(3)) {
    options.roughness = draw.of({0.3, 1.0, 3.0, 100.0});
    options.hurst = draw.between(0.1, 1.0);
    options.roughnessWindow = draw.of({0.0, 1.0, 8.5, 300.0});
  }
  options.regrowIsolated = !draw.oneIn(4);
  options.noiseSeeds = {draw.seed(), draw.seed()};
  options.keepCost = draw.oneIn(2);
  options.outerSteps = draw.of({0, 1, 3, 6, 64});
  options.tuning.stepsPerReadback = draw.of({0, 0, 1, 5});
  options.tuning.workGroupSize = draw.of({0, 0, 1, 3, 64});
  return options;
}

inline ErodeOptions anyErosion(Draw& draw) {
  ErodeOptions options;
  options.shape = draw.of({ErodeShape::cross, ErodeShape::square, ErodeShape::ellipse});
  options.size = 3 + 2 * draw.upTo(5);
  options.planes = draw.oneIn(3);
  options.iterations = draw.of({0, 1, 2, 5, 20});
  if (draw.oneIn(2)) options.threshold = draw.between(0.001, 1.0);
  if (draw.oneIn(2)) options.probability = draw.between(0.001, 1.0);
  options.on = draw.of({ErodeOn::fracture, ErodeOn::all, ErodeOn::rims});
  options.islands = draw.of({Islands::eroded, Islands::kept});
  options.seed = draw.seed();
  return options;
}

}  // namespace sherd::random_case
