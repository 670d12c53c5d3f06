// The table of growth rules.
#pragma once

#include <sherd/labels.h>

#include <cstddef>
#include <string_view>

namespace sherd {

/// How a rule grows, and which options it uses.
struct GrowthRule {
  const char* name;              ///< of the option growth and in manifests
  const char* kernel = nullptr;  ///< a kernel with the arguments of kernels/nearest.cl, which gives
                                 ///< each voxel one of the seeds; null: a method of src/grow
  bool usesNeighborhood = false;   ///< GrowOptions::neighborhood
  bool usesMetric = false;         ///< GrowOptions::metric; else the metric is Euclidean
  bool growsOverFaces = false;     ///< over 6 neighbors the voxels of a seed are connected
  bool givesVoronoiCells = false;  ///< with the Euclidean metric, so that cuts are planes, in
                                   ///< thin walls bent as these are
  bool regrowsByChamfer = false;   ///< disconnected voxels are regrown by a 5^3 chamfer first
  bool splits = false;             ///< pieces are split one after another; there are no seeds
  double bytesPerVoxel = 0.0;      ///< memory beyond that of a flood, measured
};

/// All rules.  Names are unique and stay what they are; a new rule is a new last row.
inline constexpr GrowthRule kGrowthRules[] = {
    {.name = "flood", .usesNeighborhood = true, .growsOverFaces = true},
    {.name = "nearest", .kernel = "nearest", .usesMetric = true, .givesVoronoiCells = true},
    {.name = "chain", .usesMetric = true, .growsOverFaces = true, .bytesPerVoxel = 8.5},
    {.name = "euclid", .kernel = "nearest", .givesVoronoiCells = true, .regrowsByChamfer = true},
    {.name = "sequential", .splits = true},
};

/// Returns the row of a rule.
[[nodiscard]] constexpr const GrowthRule& ruleOf(Growth growth) {
  return kGrowthRules[static_cast<std::size_t>(growth)];
}

/// Returns the rule with a name.
///   throws  Error(usage) there is none
[[nodiscard]] Growth growthNamed(std::string_view name);

/// Returns whether a growth gives each voxel the nearest seed by Euclidean distances.
[[nodiscard]] inline bool givesCells(const GrowOptions& options) {
  const GrowthRule& rule = ruleOf(options.growth);
  return rule.givesVoronoiCells && (!rule.usesMetric || options.metric == Metric::euclidean);
}

}  // namespace sherd
