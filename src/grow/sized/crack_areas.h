// Cracks between fragments, and weights that change the fragments' sizes.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// The voxel faces between two fragments.
struct CrackArea {
  std::uint16_t a = 0, b = 0;  ///< a < b
  std::uint32_t faces = 0;
};

/// Returns the cracks of all pairs of fragments that touch, ascending by a, then b.
[[nodiscard]] std::vector<CrackArea> crackAreas(const Labels& labels);

/// A spring between two fragments: voxels that pass from one to the other for each voxel squared by
/// which the difference of their weights grows.
struct WeightSpring {
  std::uint16_t a = 0, b = 0;
  double stiffness = 0.0;
};

/// Returns changes of weights, in voxels squared, that change the numbers of voxels.
///   change  [fragments + 1] voxels; the sum over fragments that springs connect is 0
[[nodiscard]] std::vector<double> weightsFor(const std::vector<WeightSpring>& springs,
                                             const std::vector<double>& change);

}  // namespace sherd
