// Solids for the tests of seeds, and what a seed set must hold.
#pragma once

#include <gtest/gtest.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "kernels/device_fixture.h"
#include "kernels/voxel_shapes.h"

namespace sherd {

/// A voxel shape as a solid with its parts; it has no distance grid.
struct ShapeSolid {
  voxel_shapes::VoxelSolid shape;
  Solid solid;
  VoxelComponents components;

  ShapeSolid(voxel_shapes::VoxelSolid voxels, Device& device) : shape(std::move(voxels)) {
    solid.blocks = voxel_shapes::blocksOf(shape);
    solid.voxels = shape.inside.size();
    solid.box = {openvdb::Coord::max(), openvdb::Coord::min()};
    for (const openvdb::Coord& voxel : shape.inside) {
      solid.box.min.minComponent(voxel);
      solid.box.max.maxComponent(voxel);
    }
    components = findComponents(*solid.blocks, device);
  }

  std::uint32_t componentOf(const openvdb::Coord& voxel) const {
    const std::size_t voxelIndex = voxel_shapes::voxelIndexOf(*solid.blocks, voxel);
    return components.at(voxelIndex);
  }

  bool onSurface(const openvdb::Coord& voxel) const {
    const auto around = voxel_shapes::neighbors(voxel);
    return std::any_of(around.begin(), around.end(),
                       [&](const openvdb::Coord& n) { return !shape.inside.count(n); });
  }

  std::set<openvdb::Coord> surface() const {
    std::set<openvdb::Coord> voxels;
    for (const openvdb::Coord& voxel : shape.inside) {
      if (onSurface(voxel)) voxels.insert(voxel);
    }
    return voxels;
  }
};

inline std::set<openvdb::Coord> voxelsOf(const std::vector<Seed>& seeds) {
  std::set<openvdb::Coord> voxels;
  for (const Seed& seed : seeds) voxels.insert(seed.voxel);
  return voxels;
}

/// The distance of two seeds, voxels.
inline double apart(Metric metric, const Seed& a, const Seed& b) {
  const glm::i64vec3 steps = stepsOf(a) - stepsOf(b);
  const auto order = static_cast<double>(metricOrder(metric, steps.x, steps.y, steps.z));
  return (metric == Metric::euclidean ? std::sqrt(order) : order) / kSeedSteps;
}

/// Whether a seed's fragment has the nearest of the first `fragments` seeds in its part, found by
/// looking at all.  A seed's point is rounded to 1/64 voxel, which moves a distance by 3/128 at
/// most; both ends of both distances make 3/32.
inline bool isOfNearest(const ShapeSolid& on, const std::vector<Seed>& seeds, std::size_t fragments,
                        const Seed& seed, Metric metric) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < fragments; ++i) {
    if (on.componentOf(seeds[i].voxel) != on.componentOf(seed.voxel)) continue;
    least = std::min(least, apart(metric, seeds[i], seed));
  }
  const Seed& own = seeds[seed.fragment - 1u];
  return on.componentOf(own.voxel) == on.componentOf(seed.voxel) &&
         apart(metric, own, seed) <= least + 3.0 / 32;
}

/// What placeSeeds promises of any seed set.
inline void expectPromises(const ShapeSolid& on, const std::vector<Seed>& seeds,
                           std::size_t fragments, std::size_t further, const SeedOptions& options) {
  ASSERT_EQ(seeds.size(), fragments + further);
  EXPECT_EQ(voxelsOf(seeds).size(), seeds.size()) << "seeds share a voxel";
  std::set<std::uint32_t> seeded;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const openvdb::Coord& voxel = seeds[i].voxel;
    ASSERT_TRUE(on.shape.inside.count(voxel)) << voxel;
    if (options.on == SeedsOn::surface) {
      EXPECT_TRUE(on.onSurface(voxel)) << voxel;
    }
    if (i < fragments) {
      EXPECT_EQ(seeds[i].fragment, i + 1);
      seeded.insert(on.componentOf(voxel));
    } else {
      EXPECT_TRUE(isOfNearest(on, seeds, fragments, seeds[i], options.mergeMetric)) << voxel;
    }
  }
  EXPECT_EQ(seeded.size(), on.components.count()) << "a part has no seed";
}

inline constexpr Sampler kSamplers[] = {Sampler::uniform, Sampler::halton, Sampler::gaussian,
                                        Sampler::poisson};
inline constexpr Metric kMetrics[] = {Metric::euclidean, Metric::chebyshev, Metric::manhattan};
inline constexpr SeedsOn kPlaces[] = {SeedsOn::volume, SeedsOn::surface};

}  // namespace sherd
