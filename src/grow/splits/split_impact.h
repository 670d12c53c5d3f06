// The pattern of an impact as splits: radial cracks first, then rings that end at them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "seed/split_impacts.h"

namespace sherd {

/// A part of the pattern that one piece holds: sectors between two angles, and rows of rings.
struct ImpactPart {
  std::size_t impact = 0;
  int sectors = 1;
  int firstRow = 0, lastRow = 1;  ///< [first, last) from the center
  double from = 0.0, to = 0.0;    ///< radians; of the whole pattern 2 pi apart

  std::size_t cells() const {
    return static_cast<std::size_t>(sectors) * static_cast<std::size_t>(lastRow - firstRow);
  }
};

/// A crack of the pattern, and what its two sides are.
struct ImpactSplit {
  glm::dvec3 center{0.0}, normal{0.0};  ///< a plane through the center
  double radius = 0.0;                  ///< above 0: a sphere, the kept side is inside
  std::optional<ImpactPart> kept{}, added{};
  std::size_t nextImpact = 0;  ///< of both pieces
  std::size_t fixed = 0;       ///< pieces that come of the kept side; 0: by cells and voxels
};

/// Returns the pattern of an impact as far as there are pieces for it: sectors before rows.
///   count  of pieces
///   path   of random numbers
[[nodiscard]] ImpactPart wholePattern(std::span<const SplitImpact> impacts, std::size_t impact,
                                      std::size_t count, std::uint64_t path);

/// Returns the ring crack that bounds a pattern.
///   count  of pieces, 2 or more
[[nodiscard]] ImpactSplit outerRing(std::span<const SplitImpact> impacts, const ImpactPart& whole,
                                    std::size_t count, std::size_t nextImpact);

/// Returns the crack that divides a part of the pattern, or nothing where it is one cell.
[[nodiscard]] std::optional<ImpactSplit> nextSplit(std::span<const SplitImpact> impacts,
                                                   const ImpactPart& part, std::size_t nextImpact,
                                                   std::uint64_t path);

/// Returns how many of `count` pieces come of the kept side: one for each cell of the pattern on
/// both sides, the others by the number of voxels.
///   return  1..count - 1
[[nodiscard]] std::size_t keptPieces(const ImpactSplit& split, std::size_t count, std::size_t kept,
                                     std::size_t added);

/// After a crack that has all voxels on one side, sets which part of the pattern the piece is.
///   mean  of the piece's voxels
void afterMiss(const ImpactSplit& split, const glm::dvec3& mean, std::size_t& nextImpact,
               std::optional<ImpactPart>& part);

}  // namespace sherd
