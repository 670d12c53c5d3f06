// Surface::exact, from labels to the meshes of fragments.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <span>

#include "surface/exact/exact_surface.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// Returns the meshes of all fragments with the surface of the solid's mesh, or why there are none:
/// the solid has no mesh, that is not closed, or cracks can't cut it.  Where only some bodies can
/// be cut, these are, and ExactSurface::smooth has the others.
///   uneroded       the labels before erosion, or null without erosion
///   adaptivity     SurfaceOptions::adaptivity, for cracks
///   neighborhoods  of the solid's leaves
///   throws         Error(cancelled)
[[nodiscard]] ExactSurface exactMeshes(const Solid& solid, const Labels& labels,
                                       const Labels* uneroded,
                                       std::span<const LeafNeighbors> neighborhoods,
                                       double adaptivity, const Progress* progress = nullptr);

}  // namespace sherd
