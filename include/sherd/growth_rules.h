// The growth rules: how fragments grow from their seeds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace sherd {

/// A row of kGrowthRules, by its index.  The named ones grow as described; further rows, which are
/// kernels of their own, have no name here: see growthNamed.
enum class Growth : std::uint8_t {
  flood,    ///< breadth-first; distances are measured around gaps
  nearest,  ///< nearest seed by the metric, across gaps: the paper's straightforward method
  chain,    ///< Discrete Voronoi Chain: across faces, in the order of the largest distance to the
            ///< seed along the path (rounded up to half voxels)
  euclid,   ///< nearest seed; voxels disconnected from their seed are regrown by a 5^3 chamfer
};

/// How a rule grows, and which options it uses.
struct GrowthRule {
  const char* name;              ///< of `--growth` and in manifests
  const char* kernel = nullptr;  ///< a kernel with the arguments of kernels/nearest.cl, which gives
                                 ///< each voxel one of the seeds; null: a method of src/grow
  bool usesNeighborhood = false;   ///< GrowOptions::neighborhood
  bool usesMetric = false;         ///< GrowOptions::metric; else the metric is Euclidean
  bool growsOverFaces = false;     ///< over 6 neighbors the voxels of a seed are connected
  bool givesVoronoiCells = false;  ///< with the Euclidean metric, so that cuts are planes
  bool regrowsByChamfer = false;   ///< disconnected voxels are regrown by a 5^3 chamfer first
  double bytesPerVoxel = 0.0;      ///< memory beyond that of a flood, measured
};

/// All rules.  Names are unique and stay what they are; a new rule is a new last row.
inline constexpr GrowthRule kGrowthRules[] = {
    {.name = "flood", .usesNeighborhood = true, .growsOverFaces = true},
    {.name = "nearest", .kernel = "nearest", .usesMetric = true, .givesVoronoiCells = true},
    {.name = "chain", .usesMetric = true, .growsOverFaces = true, .bytesPerVoxel = 8.5},
    {.name = "euclid", .kernel = "nearest", .givesVoronoiCells = true, .regrowsByChamfer = true},
};

/// Returns the row of a rule.
[[nodiscard]] constexpr const GrowthRule& ruleOf(Growth growth) {
  return kGrowthRules[static_cast<std::size_t>(growth)];
}

/// Returns the rule with a name.
///   throws  Error(usage) there is none
[[nodiscard]] Growth growthNamed(std::string_view name);

}  // namespace sherd
