// Puts fractures of several objects together as one.
#pragma once

#include <sherd/fracture.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// The fracture of an object, or of an intruder's.
struct FracturePart {
  FractureResult result;
  std::size_t only = 0;  ///< index of the one fragment that is kept, of an intruder; kAllKept
};
inline constexpr std::size_t kAllKept = ~std::size_t{0};

struct ComposedFracture {
  FractureResult result;  ///< with `objectOf`; without `surfaces` and `unmerged`, as its meshes are
                          ///< there, and without splits
  std::vector<std::vector<std::uint16_t>> newIds;  ///< [parts][id], [0] 0
};

/// Returns the index and the number of parts as one fracture: all kept fragments in a random order,
/// then those that are withheld.
///   parts   whose solids have one voxel size and origins that differ by whole leaf nodes along x,
///           each beyond the leaf nodes of the one before; with meshes
///   throws  Error(input) more than kMaxFragments fragments
[[nodiscard]] ComposedFracture composed(std::vector<FracturePart> parts, std::uint64_t seed);

/// Returns intact objects as one fragment of one fracture.
[[nodiscard]] FractureResult composedWhole(std::vector<FractureResult> wholes);

}  // namespace sherd
