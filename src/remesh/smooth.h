// Smoothing of meshes that share vertices.
#pragma once

#include <sherd/fragments.h>

#include <span>
#include <vector>

#include "remesh/complex.h"

namespace sherd {

/// Returns true if the options have iterations to do.
///   longestSide  of the solid's box, voxels
[[nodiscard]] bool movesAnything(const SmoothOptions& options, int longestSide);

/// Smooths meshes as `smoothed` does, but moves vertices with one positionId to the mean of their
/// new positions, so that shared faces stay shared.  Closed surfaces of fewer than 100 triangles
/// (pores and islands of one to three voxels) are not smoothed: they would shrink to a point.
///   throws  Error(cancelled)
void smoothTogether(std::span<LabeledMesh> meshes, const SmoothOptions& options, int longestSide,
                    const Progress* progress = nullptr);

/// Returns whether vertices are displaced by SurfaceOptions::mismatch or scanNoise.
[[nodiscard]] bool hasNoise(const SurfaceOptions& options);

/// Returns the adaptivity of the cracks of exact surfaces.
[[nodiscard]] double crackAdaptivity(const SurfaceOptions& options);

/// Returns whether SurfaceOptions::meshes may be false.
[[nodiscard]] bool canLackMeshes(const SurfaceOptions& options);

/// Returns whether points are sampled of the labels' surfaces, whatever is made of them: before
/// triangles are merged, vertices replaced or moved by noise, which then moves the points.
[[nodiscard]] bool samplesLabelSurfaces(const SurfaceOptions& options);

}  // namespace sherd
