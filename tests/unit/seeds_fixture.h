// Solids for the tests of seeds, and what a seed set must hold.
#pragma once

#include <gtest/gtest.h>
#include <sherd/seeds.h>

#include <algorithm>
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

/// The id of the nearest of the first `fragments` seeds in the voxel's part, found by looking at
/// all.
inline std::uint16_t nearestFragment(const ShapeSolid& on, const std::vector<Seed>& seeds,
                                     std::size_t fragments, const openvdb::Coord& voxel,
                                     Metric metric) {
  const Seed* best = nullptr;
  for (std::size_t i = 0; i < fragments; ++i) {
    if (on.componentOf(seeds[i].voxel) != on.componentOf(voxel)) continue;
    if (!best ||
        metricOrder(metric, seeds[i].voxel, voxel) < metricOrder(metric, best->voxel, voxel)) {
      best = &seeds[i];
    }
  }
  return best ? best->fragment : std::uint16_t{0};
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
      EXPECT_EQ(seeds[i].fragment,
                nearestFragment(on, seeds, fragments, voxel, options.mergeMetric));
    }
  }
  EXPECT_EQ(seeded.size(), on.components.count()) << "a part has no seed";
}

inline constexpr Sampler kSamplers[] = {Sampler::uniform, Sampler::halton, Sampler::gaussian,
                                        Sampler::poisson};
inline constexpr Metric kMetrics[] = {Metric::euclidean, Metric::chebyshev, Metric::manhattan};
inline constexpr SeedsOn kPlaces[] = {SeedsOn::volume, SeedsOn::surface};

}  // namespace sherd
