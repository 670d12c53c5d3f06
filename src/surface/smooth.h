// Smoothing meshes that share vertices.
#pragma once

#include <sherd/surface.h>

#include <span>
#include <vector>

#include "surface/complex.h"

namespace sherd {

/// Is there any smoothing to be done?
[[nodiscard]] bool movesAnything(const SmoothOptions& options, int longestSide);

/// Smooth meshes as `smoothed` does each, but vertices at one place go to the mean of where each
/// would: what meshes share stays shared.  Closed surfaces of fewer than 100 triangles, round pores
/// and crumbs of a voxel or three, stay as they are: they would shrink to a point.
///   facing  [meshes][triangles]
///   throws  Error(cancelled)
void smoothTogether(std::span<LabelledMesh> meshes,
                    std::span<const std::vector<std::uint16_t>> facing,
                    const SmoothOptions& options, int longestSide,
                    const Progress* progress = nullptr);

}  // namespace sherd
