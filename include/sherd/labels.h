// Growth: assigns every voxel to a fragment.
#pragma once

#include <sherd/device.h>
#include <sherd/growth_rules.h>
#include <sherd/leaf_blocks.h>
#include <sherd/metric.h>
#include <sherd/progress.h>
#include <sherd/seeds.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// An anisotropic metric: lengths along `direction` are divided by 1 + strength.
struct Anisotropy {
  glm::dvec3 direction{0.0, 0.0, 1.0};  ///< any length but 0
  double strength = 0.0;  ///< -0.75..9; > 0: splinters along `direction` (wood); < 0: plates across
                          ///< it (slate); 0: isotropic
};

/// Seeds whose Voronoi cells are the fragments.
struct VoronoiSites {
  std::vector<Seed> seeds;
  Anisotropy anisotropy{};  ///< scales the Euclidean distances
};

/// Fragment ids over the leaf blocks.
struct Labels {
  static constexpr std::uint16_t kEroded = 65535;  ///< an eroded or withheld voxel

  std::vector<std::uint16_t> fragment;  ///< [leaf*512] 1..n or kEroded on inside voxels and,
                                        ///< extended, on the exterior band; else 0
  /// [leaf*512] arrival cost of inside voxels in the unit of the growth, else 0; empty without
  /// GrowOptions::keepCost.  Regrown and roughened voxels keep the cost of the first growth.
  std::vector<std::uint32_t> cost;
  /// Per search, the number of voxels disconnected from their fragment's first seed.  All of them
  /// were regrown.
  std::vector<std::uint64_t> disconnected;
  VoronoiSites sites{};  ///< if not empty, voxels belong to the nearest of these seeds except
                         ///< where they were regrown or eroded, so cuts are planes.  Empty for
                         ///< growths without this property
};

/// How work is given to the device.  Results are the same.
struct DeviceTuning {
  int stepsPerReadback = 0;  ///< layers between reads of the device's counter; 0: automatic
  int workGroupSize = 0;     ///< work-items per work-group; 0: automatic
  bool warmUp = false;  ///< also runs passes that have no work, so that a later growth over the
                        ///< same leaf blocks allocates buffers only for the leaves around
                        ///< voxels that are disconnected from their seed
};

struct GrowOptions {
  Growth growth = Growth::euclid;
  int neighborhood = 6;               ///< for flood: 6 (von Neumann) or 26 (Moore)
  Metric metric = Metric::euclidean;  ///< for nearest and chain
  Anisotropy anisotropy{};
  double roughness = 0.0;      ///< rms height of a crack over a window, voxels, 0..100; 0: smooth
  double hurst = 0.8;          ///< Hurst exponent of rough cracks, 0.1..1; 0.8 is measured on most
                               ///< brittle materials (Bouchaud 1997)
  double roughnessWindow = 0;  ///< side of that window, voxels; 0: a tenth of the longest side
  bool regrowIsolated = true;  ///< gives voxels disconnected from their fragment's first seed to
                               ///< neighbors, so that every fragment is 6-connected
  std::vector<std::uint64_t> noiseSeeds{};  ///< [seed sets] for rough cracks; missing ones are 0
  bool keepCost = false;                    ///< also returns the arrival cost
  int outerSteps = 6;  ///< steps by which labels are extended into the exterior band, 0..64
  DeviceTuning tuning{};
};

/// Grows fragments from all seeds at once over the inside.  A voxel belongs to the fragment that
/// reaches it at the lowest (cost, id), so the result does not depend on device, work-group size or
/// batch.
///   seedSets  one per fracture, grown together over the same leaf blocks, in batches that fit the
///             device's memory and largest allocation; every seed on an inside voxel; a fragment
///             stays connected to its first seed
///   return    one Labels per seed set; inside voxels of components without a seed stay 0
///   throws    Error(device); Error(cancelled); Error(usage) a seed outside the solid, an option
///             out of range
///   source    Velic, May, Moresi, A fast robust algorithm for computing discrete Voronoi diagrams,
///             2009
[[nodiscard]] std::vector<Labels> grow(const LeafBlocks& blocks,
                                       std::span<const std::vector<Seed>> seedSets, Device& device,
                                       const GrowOptions& options = {},
                                       const Progress* progress = nullptr);

/// Extends the labels of inside voxels (eroded ones included) `steps` face steps into the exterior
/// band, so that cuts reach past the surface.  Labels that the band already has are replaced.
///   throws  Error(device)
[[nodiscard]] Labels extendLabels(const LeafBlocks& blocks, Labels labels, Device& device,
                                  int steps = 6);

/// Counts the inside voxels of each fragment: [fragments+1], [0] those without a label.  Eroded
/// voxels are not counted.
[[nodiscard]] std::vector<std::uint64_t> countVoxels(const LeafBlocks& blocks, const Labels& labels,
                                                     int fragments);

}  // namespace sherd
