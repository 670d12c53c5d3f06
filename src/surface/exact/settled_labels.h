// Labels that agree with exact meshes.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstdint>
#include <span>

#include "surface/exact/exact_surface.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// Returns what exactMeshes does, of labels that agree with it.
///
/// Voxels connect what the mesh parts: where a fragment hangs together by less than a voxel, its
/// mesh is several bodies, and all but the largest go to the fragments that they touch most
/// (ExactSurface::moved).  The voxels of those that have at least kSmallComponentVoxels go with
/// them, and the cut is made anew.  Labels of eroded fragments stay, and so do those without which
/// a fragment would be in several parts or too small.
///   labels         may be changed
///   uneroded       the labels before erosion, or null without erosion
///   least          voxels of a fragment that loses some
///   adaptivity     SurfaceOptions::adaptivity, for cracks
///   neighborhoods  of the solid's leaves
///   throws         Error(cancelled)
[[nodiscard]] ExactSurface settledExactMeshes(const Solid& solid, Labels& labels,
                                              const Labels* uneroded, std::uint64_t least,
                                              std::span<const LeafNeighbors> neighborhoods,
                                              double adaptivity, const Progress* progress);

}  // namespace sherd
