// Faces that edge collapses made cross.
#pragma once

#include <sherd/progress.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "remesh/collapse_log.h"
#include "remesh/complex.h"

namespace sherd {

using FacePair = std::array<std::uint32_t, 2>;

/// Returns the faces whose corners are not all 0, as surfaces of which no mesh is made, with the
/// vertices that they have.
[[nodiscard]] LabeledComplex withoutGone(std::span<const glm::dvec3> vertices,
                                         std::span<const ComplexFace> faces);

/// Returns the pairs of faces that cross, of those with corners that are not all 0.
///   isTested  [faces] 0 or 1: with one that has 1
///   throws    Error(cancelled)
[[nodiscard]] std::vector<FacePair> facesThatCross(std::span<const glm::dvec3> vertices,
                                                   std::span<const ComplexFace> faces,
                                                   std::span<const std::uint8_t> isTested,
                                                   const Progress* progress);

/// Returns the face of each pair for which less is undone, ascending; none of faces as they were.
///   depth  CollapseLog::undo's
[[nodiscard]] std::vector<std::uint32_t> cheapestToUndo(std::span<const FacePair> pairs,
                                                        const CollapseLog& log, std::size_t depth);

}  // namespace sherd
