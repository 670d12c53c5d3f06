// Growth: which fragment owns each voxel.
#pragma once

#include <sherd/device.h>
#include <sherd/leaf_blocks.h>
#include <sherd/metric.h>
#include <sherd/progress.h>
#include <sherd/seeds.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Anisotropy: along `direction`, lengths count as divided by 1 + strength.
struct Grain {
  glm::dvec3 direction{0.0, 0.0, 1.0};  ///< any length but 0
  double strength = 0.0;  ///< -0.75..9; above 0 splinters along it (wood), below 0 plates across
                          ///< it (slate), 0 none
};

/// Seeds whose Voronoi cells fragments are.
struct VoronoiSites {
  std::vector<Seed> seeds;
  Grain grain{};  ///< distances are euclidean under it
};

/// Fragment ids over the leaf blocks.
struct Labels {
  static constexpr std::uint16_t kWorn = 65535;  ///< a voxel that was worn off, or withheld

  std::vector<std::uint16_t> fragment;  ///< [leaf*512] 1..n or kWorn on inside voxels, and carried
                                        ///< over the outer band; else 0
  std::vector<std::uint32_t> cost;      ///< [leaf*512] arrival cost of inside voxels in the
                                        ///< growth's own unit, else 0; empty unless asked for.  Of
                                        ///< voxels that were regrown or roughened it stays that of
                                        ///< the first growth
  std::vector<std::uint64_t> freed;     ///< voxels cut off from their fragment's first seed, each
                                        ///< time they were looked for; all of them were regrown
  VoronoiSites sites{};  ///< where voxels belong to the nearest of these seeds, but for what was
                         ///< regrown, or worn: the cut between two is then a plane.  Empty where
                         ///< growth goes by other rules
};

/// How fragments spread from their seeds.
enum class Growth {
  flood,    ///< layer by layer; the shape of a fragment follows the way round gaps
  nearest,  ///< nearest seed by the metric, blind to gaps: the paper's straightforward way
  chain,    ///< Discrete Voronoi Chain: over faces, in the order of the largest distance to the
            ///< seed met on the way (distances rounded up to half voxels decide the order)
  euclid,   ///< nearest seed; what is cut off from its seed is regrown by a 5^3 chamfer
};

struct GrowOptions {
  Growth growth = Growth::euclid;
  int neighborhood = 6;               ///< of flood: 6 (von Neumann) or 26 (Moore)
  Metric metric = Metric::euclidean;  ///< of nearest and chain
  Grain grain{};
  double roughness = 0.0;      ///< rms height in voxels of a crack over a window, 0 smooth, 0..100
  double hurst = 0.8;          ///< Hurst exponent of rough cracks, 0.1..1; 0.8 is measured on most
                               ///< brittle materials (Bouchaud 1997)
  double roughnessWindow = 0;  ///< side of that window in voxels; 0: a tenth of the longest side
  bool regrowIsolated = true;  ///< voxels cut off from their fragment's first seed are given to
                               ///< neighbours, so that every fragment is 6-connected
  std::vector<std::uint64_t> noiseSeeds{};  ///< [seed sets] of rough cracks; missing ones are 0
  bool keepCost = false;                    ///< also return the arrival cost
  bool rehearse = false;     ///< also go ways where nothing is to be done: a later growth over the
                             ///< same leaf blocks then needs no new buffers.  Labels are the same
  int outerSteps = 6;        ///< how many steps labels are carried over the outer band, 0..64
  int stepsPerReadback = 0;  ///< layers between two looks at the device's counter; 0: chosen
  int workGroupSize = 0;     ///< work-items per work-group; 0: chosen for the device
};

/// Grow fragments from all seeds at once over the inside.  A voxel belongs to the fragment that
/// reaches it at the lowest (cost, id): one answer, whatever the device, work-group size or batch.
///   seedSets  one fracture each, grown together over the same leaf blocks, as many at a time as
///             the device's memory and largest allocation have room for; every seed on an inside
///             voxel; a fragment's first seed is the one that its part must hold
///   return    one Labels per seed set; inside voxels of parts without a seed stay 0
///   throws    Error(device), Error(cancelled), Error(usage) a seed outside the solid, an option
///             out of range
///   source    Velic, May, Moresi, A fast robust algorithm for computing discrete Voronoi diagrams,
///             2009
[[nodiscard]] std::vector<Labels> grow(const LeafBlocks& blocks,
                                       std::span<const std::vector<Seed>> seedSets, Device& device,
                                       const GrowOptions& options = {},
                                       const Progress* progress = nullptr);

/// Carry labels of inside voxels (worn ones too) `steps` steps over the outer band, face by face,
/// where cuts must reach past the surface.  Labels that lie there are replaced.
///   throws  Error(device)
[[nodiscard]] Labels carriedOverBand(const LeafBlocks& blocks, Labels labels, Device& device,
                                     int steps = 6);

/// Inside voxels of each fragment: [n+1], [0] counts those without a label; worn ones count
/// nowhere.
[[nodiscard]] std::vector<std::uint64_t> countVoxels(const LeafBlocks& blocks, const Labels& labels,
                                                     int fragments);

}  // namespace sherd
