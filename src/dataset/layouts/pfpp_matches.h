// True matches between the points of touching fragments.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "formats/arrays/npy_objects.h"

namespace sherd {

/// What PuzzleFusion++ gets of Jigsaw's network, from labels instead.
struct PfppMatching {
  std::vector<std::size_t> edges;     ///< [tables, 2] parts j > i
  std::vector<NpyTable> tables;       ///< [rows, 2] of critical points of i and of j
  std::vector<std::size_t> critical;  ///< [points] of each part its points on cracks, by their
                                      ///< place in the part, at the part's first places; else 0
  std::vector<std::size_t> criticalCounts;  ///< [parts]
};

/// Matches the points of two parts that lie on their common crack, one to one: those that are each
/// other's nearest.  Parts with fewer than three matches get no edge, as in Jigsaw.
///   positions  [n] those of part 0, then of part 1, ..
///   neighbor   [n] 0 on the original surface, k: the point faces part k - 1, if there is one
///   counts     [parts]
[[nodiscard]] PfppMatching pfppMatching(std::span<const glm::vec3> positions,
                                        std::span<const std::uint16_t> neighbor,
                                        std::span<const std::size_t> counts);

}  // namespace sherd
